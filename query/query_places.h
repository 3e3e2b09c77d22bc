/// Lookup of the shard that stores a voxel of a level, for rays. The result is a cell, an overview, or a lost cell.
///
/// If the whole scene has one root overview, a page of the scene is read when a ray reaches a block of this page. The
/// memory of the pages is bounded. In other scenes, all pages are read at the start. This includes scenes with lost
/// cells, because the position of a lost cell depends on the other cells of its column.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "format/scene/paged_scene.h"
#include "kernels/marching/locate.h"
#include "viewer/stream/cell_layout.h"
#include "viewer/stream/numbered_shards.h"
#include "viewer/stream/shard_map.h"

namespace gigabake {

/// The shard at a voxel, and the box for which the answer is the same.
struct QueryPlace {
  enum class Kind {
    nothing,
    shard,
    lost,
    unknown  ///< `page` must be read first
  };
  Kind kind = Kind::nothing;
  std::uint32_t shard = 0;  ///< shard number; for a lost cell, the argument of lost_name()
  kernels::VoxelBox box{};
  PageKey page{};
};

class QueryPlaces {
 public:
  /// Borrows `numbers`. `page_bytes` is the maximum memory of the scene's pages.
  /// Cost    Reads only scene.xml if the scene has one root. Otherwise, reads every page of the scene and keeps about
  ///         40 bytes per cell.
  /// Errors  InputError: the errors of lay_out_cells() and PagedScene::cells().
  QueryPlaces(NumberedShards& numbers, std::uint64_t page_bytes, const ThreadPool& pool);

  /// Returns the number of levels: levels of the cells and, if present, of the overviews. A scene with lost cells is
  /// queried without overviews, because overviews do not mark lost cells.
  int lods() const { return lods_; }
  /// Returns the bounding box of all cells, including lost ones.
  const kernels::VoxelBox& window() const { return window_; }

  /// Returns the shard that stores level `lod` at lod-0 voxel v. Any number of threads may call find() concurrently,
  /// but not concurrently with read().
  /// Range   lod < lods().
  QueryPlace find(int lod, const std::int64_t v[3]) const;

  /// Reads pages that find() reported as unknown. At least one of these pages is in memory in the next pass of the
  /// rays.
  /// Errors  InputError: a page cannot be read.
  void read(const std::vector<PageKey>& pages);
  std::uint64_t pages_read() const { return pager_ ? pager_->counts().reads : 0; }

  /// Lays out all cells, for a device that finds cells without pages.
  /// Cost    If has_pages(), the first call reads every page of the scene and uses 0.6 KB per cell while it reads.
  /// Errors  InputError: the errors of lay_out_cells() and PagedScene::cells().
  void lay_out_all(const ThreadPool& pool);
  /// Returns the layout of all cells.
  /// Range   lay_out_all() was called, or has_pages() is false.
  const CellLayout& layout() const { return layout_; }
  /// Returns the shard of a cell of the layout; nullopt for a rim cell (viewer/stream/cell_layout.h).
  std::optional<std::uint32_t> shard_of_cell(std::size_t cell) const;
  bool has_pages() const { return map_.has_value(); }

  bool is_lost(std::uint32_t shard) const { return shard >= first_lost_; }
  const std::string& lost_name(std::uint32_t shard) const { return lost_[shard - first_lost_]; }

 private:
  void lay_out(const PagedScene& scene, const ThreadPool& pool);
  void place_cells(const PagedScene& scene, const ThreadPool& pool);
  QueryPlace find_in_pages(int lod, const std::int64_t v[3]) const;
  QueryPlace find_in_layout(const std::int64_t v[3]) const;
  Page read_page(const PageKey& key);

  NumberedShards& numbers_;
  int lods_ = 0;
  kernels::VoxelBox window_{};
  CellLayout layout_;
  std::vector<std::uint32_t> number_;  ///< shard number by cell of the layout
  std::uint32_t first_lost_ = 0;
  std::vector<std::string> lost_;
  std::mutex mutex_;
  std::exception_ptr unreadable_;  ///< the error of a page that could not be read
  std::optional<ShardMap> map_;    ///< only for a scene with one root
  std::unique_ptr<Pager> pager_;   ///< pages of map_; destroyed first, because its threads call read_page()
};

}  // namespace gigabake
