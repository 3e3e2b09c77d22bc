/// Checks that a shard is the one that its scene describes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/scene/xml/scene_xml.h"
#include "format/shard/shard.h"
#include "format/shard/shard_reader.h"

namespace gigabake {

/// An attribute that differs, and a description of the difference.
struct HeaderDifference {
  std::string attribute, what;
};

/// Returns the differences between the header and the scene's entry for `cell`; empty if they match.
std::vector<HeaderDifference> differences_from_scene(const ShardHeader& header, const SceneHeader& scene,
                                                     const SceneCell& cell);

/// Checks that the header and the size of the file match the scene's entry for `cell`. A file that another program has
/// rewritten could have a table of chunks that is not of its datasets.
/// Errors  InputError with the first difference and the remedy.
void expect_shard_of_scene(const std::filesystem::path& shard, const ShardHeader& header, const SceneHeader& scene,
                           const SceneCell& cell);

/// Opens the shard of a cell. All code that reads voxels of a scene must use this function.
/// Errors  InputError: the file is missing, not a shard, or not the shard that the scene describes.
ShardReader open_shard_of_scene(const std::filesystem::path& scene_xml, const SceneHeader& scene,
                                const SceneCell& cell);

}  // namespace gigabake
