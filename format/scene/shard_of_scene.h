/// Whether a shard is the one that its scene means.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/scene/scene_xml.h"
#include "format/shard/shard.h"
#include "format/shard/shard_reader.h"

namespace gigabake {

/// An attribute that differs, and in what.
struct HeaderDifference {
  std::string attribute, what;
};

/// Empty where the header is what `scene` says of `cell`.
std::vector<HeaderDifference> differences_from_scene(const ShardHeader& header, const SceneHeader& scene,
                                                     const SceneCell& cell);

/// Errors  InputError: the first difference, and what to do.
void expect_shard_of_scene(const std::filesystem::path& shard, const ShardHeader& header, const SceneHeader& scene,
                           const SceneCell& cell);

/// The shard of a cell, open: the way for everybody who reads voxels of a scene.
/// Errors  InputError: no such file, not a shard, not the one that the scene means.
ShardReader open_shard_of_scene(const std::filesystem::path& scene_xml, const SceneHeader& scene,
                                const SceneCell& cell);

}  // namespace gigabake
