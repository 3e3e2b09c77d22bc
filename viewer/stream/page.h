/// Parts of a scene that come and go as one: a block of a shard's node rows, a block of bricks of one level, or what
/// one page of the scene lists. The former stand in Morton order, so a block is a compact piece of the shard, and a
/// whole tree never has to be here.
#pragma once

#include <array>
#include <atomic>
#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "format/scene/paged_scene.h"
#include "format/shard/shard.h"

namespace gigabake {

inline constexpr std::uint32_t nodes_per_block = 4096, bricks_per_block = 512;

/// Cells are numbered in the order of the scene's pages, from 0; behind them parents, those of a page before those of
/// the pages below it.
struct PageKey {
  std::uint32_t shard = 0;  ///< its number; of a page of the scene: of the first cell there
  std::int32_t part = -1;   ///< node_rows; listing and below; else bricks of this level, counted from the shard's own 0
  std::uint32_t block = 0;  ///< rows (bricks) block·nodes_per_block (block·bricks_per_block) and on

  static constexpr std::int32_t node_rows = -1;
  /// What a page of the scene lists that scene.xml refers to; a page that this refers to: one less, and so on.
  static constexpr std::int32_t listing = -2;

  friend auto operator<=>(const PageKey&, const PageKey&) = default;
};

struct ListedCell {
  std::array<std::int64_t, 3> min{};
  std::uint32_t number = 0;
};

struct ListedParent {
  std::uint32_t own_lod = 0;
  std::array<std::int64_t, 3> min{};
  std::uint32_t index = 0;  ///< number without the cells before it
};

struct ListedPage {
  LatticeBlock block;
  std::uint32_t first_cell = 0;
};

struct Page {
  std::vector<NodeRow> rows;      ///< empty, or
  BrickBlock bricks;              ///< (format/shard/shard.h) empty, or
  std::vector<ListedCell> cells;  ///< by min x, y, z; empty, or
  std::vector<ListedPage> pages;
  std::vector<ListedParent> parents;  ///< with those two; by own_lod, then by min x, y, z

  std::uint64_t bytes() const;  ///< of memory
};

/// Reads one page; called from several threads at once.
/// Exact   Children of a row lie behind it in the table and inside it; masks, `first` and the columns agree.
/// Errors  InputError: no such shard, damaged, not of this scene, or no such block.
using PageSource = std::function<Page(const PageKey&)>;

/// As a viewer searches them. first: the number of the first one.
std::vector<ListedCell> listed_cells(const std::vector<SceneCell>& cells, std::uint32_t first);
std::vector<ListedPage> listed_pages(const std::vector<PageReference>& pages, std::uint32_t first);
std::vector<ListedParent> listed_parents(const std::vector<SceneCell>& parents, std::uint32_t first);

/// How many shards are open at once; the longest unused is closed. Processes may have 1024 files open.
inline constexpr std::size_t most_open_shards = 400;

/// From the scene's pages and shards. files_opened: where given, counts each that is opened.
PageSource pages_from_files(std::shared_ptr<const PagedScene> scene,
                            std::shared_ptr<std::atomic<std::uint64_t>> files_opened = {});

}  // namespace gigabake
