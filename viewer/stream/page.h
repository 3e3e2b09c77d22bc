/// Parts of a shard that come and go as one: a block of node rows, or a block of bricks of one level. Both stand in
/// Morton order, so a block is a compact piece of the cell, and a whole tree never has to be here.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "format/scene/scene_xml.h"
#include "format/shard/shard.h"

namespace gigabake {

inline constexpr std::uint32_t nodes_per_block = 4096, bricks_per_block = 512;

struct PageKey {
  std::uint32_t cell = 0;   ///< index into SceneDescription::cells
  std::int32_t lod = -1;    ///< -1: node rows; else bricks of this level
  std::uint32_t block = 0;  ///< rows (bricks) block·nodes_per_block (block·bricks_per_block) and on

  friend auto operator<=>(const PageKey&, const PageKey&) = default;
};

struct Page {
  std::vector<NodeRow> rows;  ///< empty, or
  BrickBlock bricks;          ///< (format/shard/shard.h)

  std::uint64_t bytes() const;  ///< of memory
};

/// Reads one page; called from several threads at once.
/// Exact   Children of a row lie behind it in the table and inside it; masks, `first` and the columns agree.
/// Errors  InputError: no such shard, damaged, not of this scene, or no such block.
using PageSource = std::function<Page(const PageKey&)>;

/// How many shards are open at once; the longest unused is closed. Processes may have 1024 files open.
inline constexpr std::size_t most_open_shards = 256;

/// From the shards that `scene`, read from `scene_path`, lists. Borrows `scene`.
PageSource pages_from_shards(const std::filesystem::path& scene_path, const SceneDescription& scene);

}  // namespace gigabake
