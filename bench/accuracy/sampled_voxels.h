/// A random sample of a scene's finest voxels, with their attributes from the shards.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/math/vec3.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake::bench {

struct SampledVoxel {
  Vec3i64 at{};  ///< in voxels of the bake's lattice
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};  ///< zeros if the scene has no normals
};

/// Returns at most `maximum` voxels of lod 0: one at random from each run of equal length, in the order of the shards.
/// Errors  InputError: a shard cannot be read.
std::vector<SampledVoxel> sample_voxels(const SceneDescription& scene, const std::filesystem::path& scene_path,
                                        std::uint64_t maximum, std::uint64_t seed);

}  // namespace gigabake::bench
