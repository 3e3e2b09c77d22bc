/// Parts of a shard that come and go as one: a block of node rows, or a block of bricks of one level. Both stand in
/// Morton order, so a block is a compact piece of the cell, and a whole tree never has to be here.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "format/scene_xml.h"
#include "format/shard.h"

namespace gigabake {

inline constexpr std::uint32_t nodes_per_block = 4096, bricks_per_block = 512;

struct PageKey {
  std::uint32_t cell = 0;   ///< index into SceneDescription::cells
  std::int32_t lod = -1;    ///< -1: node rows; else bricks of this level
  std::uint32_t block = 0;  ///< rows (bricks) block·nodes_per_block (block·bricks_per_block) and on

  friend auto operator<=>(const PageKey&, const PageKey&) = default;
};

/// A row of NodeTable (format/shard.h). The row's key follows from the way down to it.
struct NodeRow {
  std::uint32_t first_child = 0xffffffffu;  ///< row in the whole table
  std::uint32_t value = 0;                  ///< brick number in its whole level, or rgba
  std::int8_t normal[2] = {0, 0};
  NodeKind kind = NodeKind::brick;
  std::uint8_t child_mask = 0;
};

/// Bricks of one level: as BrickLevel, with `first` counted from the block's own voxels.
struct BrickBlock {
  std::vector<std::uint64_t> mask;   ///< 8 per brick
  std::vector<std::uint32_t> first;  ///< bricks+1
  std::vector<std::uint8_t> rgba;    ///< 4 per voxel
  std::vector<std::int8_t> normal;   ///< 2 per voxel; empty where the channel is off
};

struct Page {
  std::vector<NodeRow> rows;  ///< empty, or
  BrickBlock bricks;

  std::uint64_t bytes() const;
};

/// Reads one page; called from several threads at once.
/// Exact   Children of a row lie behind it in the table and inside it; masks, `first` and the columns agree.
/// Errors  InputError: no such shard, damaged, not of this scene, or no such block.
using PageSource = std::function<Page(const PageKey&)>;

/// From the shards that `scene`, read from `scene_path`, lists. Keeps a bounded number of files open. Borrows `scene`.
PageSource pages_from_shards(const std::filesystem::path& scene_path, const SceneDescription& scene);

}  // namespace gigabake
