/// Where the pictures' voxels come from: a cell's node table and levels, one at a time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "format/scene_xml.h"
#include "format/shard.h"

namespace gigabake {

/// cell: index into SceneDescription::cells.
/// Errors  InputError.
struct CellReader {
  std::function<NodeTable(std::size_t cell)> nodes;
  std::function<BrickLevel(std::size_t cell, int lod)> level;
};

/// Reads the shards that `scene`, which was read from `scene_path`, lists. Borrows `scene`.
CellReader read_from_shards(const std::filesystem::path& scene_path, const SceneDescription& scene);

}  // namespace gigabake
