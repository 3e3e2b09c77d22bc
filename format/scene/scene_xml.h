/// The paged scene: which shards there are and where (scene.xml, the thesis's schema with our attributes;
/// docs/format.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/shard/shard.h"
#include "lattice/frames.h"

namespace gigabake {

/// One cell as the scene lists it.
struct SceneCell {
  std::string name;
  std::string file;  ///< shard, relative to the scene.xml
  std::array<std::int64_t, 3> lattice_min{};
  std::uint32_t cell_voxels = 0;
  std::uint32_t lods = 0;
  std::uint64_t bytes = 0;
  std::uint64_t triangles = 0;
  std::vector<std::uint64_t> voxels;  ///< per lod
  Hash128 fingerprint;
  std::vector<Hash128> content_hash;  ///< per lod
  std::uint32_t first_lod = 0;        ///< of the lattice: its own level 0. 0: a cell; else a parent
};

/// Anything the bake was asked for and could not deliver.
struct SceneLoss {
  std::string name, reason;
};

struct SceneDescription {
  std::string generator;
  double voxel_size_m = 0;
  std::array<double, 3> lattice_origin_m{};
  std::optional<Geodetic> origin;
  bool has_normals = true;
  bool has_facing = false;
  std::string parameters;  ///< the bake's parameters as one line of JSON
  std::uint64_t triangles = 0, non_finite = 0, zero_area = 0, skipped_points = 0, skipped_lines = 0;
  std::vector<SceneCell> cells;    ///< sorted by lattice_min z, y, x
  std::vector<SceneCell> parents;  ///< of the levels above the cells', each after its children
  std::vector<SceneLoss> losses;
};

/// Replaces `path` atomically (write aside, fsync, rename, fsync folder).
void write_scene(const std::filesystem::path& path, const SceneDescription& scene);
/// Errors  InputError: not XML, unknown version, missing or malformed attribute, shard paths leaving the folder.
SceneDescription read_scene(const std::filesystem::path& path);

}  // namespace gigabake
