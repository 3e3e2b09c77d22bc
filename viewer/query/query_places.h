/// Lookup of the shard that holds a voxel of a level, for rays: cells, overviews, and cells that a bake lost.
///
/// If the whole scene has one root, a page of its index is read when a ray reaches the blocks of that page. The pages
/// in memory are bounded. The index of other scenes is read completely at the start. This includes scenes with lost
/// cells: the position of a lost cell depends on the other cells of its column.
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

/// The contents at a voxel, and the box for which they hold.
struct QueryPlace {
  enum class Kind {
    nothing,
    shard,
    lost,
    unknown  ///< `page` must be read first
  };
  Kind kind = Kind::nothing;
  std::uint32_t shard = 0;  ///< number of NumberedShards; for a lost cell, the argument of lost_name()
  kernels::VoxelBox box{};
  PageKey page{};
};

class QueryPlaces {
 public:
  /// Borrows `numbers` and the pool. page_bytes: bound of the scene's pages in memory.
  /// Cost    One root: reads only scene.xml. Several roots: reads every page and keeps about 40 bytes per cell.
  /// Errors  InputError, as lay_out_cells().
  QueryPlaces(NumberedShards& numbers, std::uint64_t page_bytes, const ThreadPool& pool);

  /// Returns the number of levels: levels of the cells and, if present, of the overviews. A scene with lost cells is
  /// queried without overviews, because these do not mark lost cells.
  int lods() const { return lods_; }
  /// Returns the bounding box of all cells, including lost ones.
  const kernels::VoxelBox& window() const { return window_; }

  /// Returns the contents at voxel v. Any number of threads may call it concurrently, but not concurrently with read().
  /// Range   lod < lods().
  QueryPlace find(int lod, const std::int64_t v[3]) const;

  /// Reads pages that find() reported as unknown. At least the first page is in memory in the next pass of the rays.
  /// Errors  InputError: a page cannot be read.
  void read(const std::vector<PageKey>& pages);
  std::uint64_t pages_read() const { return pager_ ? pager_->counts().reads : 0; }

  /// Lays out all cells, for rays that find them without pages.
  /// Cost    Scene with pages: reads every page at the first call, 0.6 KB per cell while it is read.
  /// Errors  InputError, as lay_out_cells().
  void lay_out_all(const ThreadPool& pool);
  /// Returns the cells. Range: after lay_out_all().
  const CellLayout& layout() const { return layout_; }
  /// Returns the shard of a cell of the layout; nullopt: it has none.
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
  std::vector<std::uint32_t> number_;  ///< by cell of the layout
  std::uint32_t cells_ = 0, first_lost_ = 0;
  std::vector<std::string> lost_;
  std::mutex mutex_;
  std::exception_ptr unreadable_;  ///< the error of a page that could not be read
  std::optional<ShardMap> map_;    ///< only for a scene with one root
  std::unique_ptr<Pager> pager_;   ///< its pages; destroyed first, because its threads call read_page()
};

}  // namespace gigabake
