/// Which shard of a scene holds a voxel of some level, for rays that go from place to place: cells, the parents above
/// them, and the cells that a bake lost.
///
/// If all of a scene hangs from one root, its pages are read when a ray comes to their blocks, and a bounded part of
/// them is in memory. A scene without parents, or one that lost cells, is laid out at once: where a lost cell is
/// follows from all other cells of its column.
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
#include "kernels/cast/locate.h"
#include "viewer/stream/cell_layout.h"
#include "viewer/stream/numbered_shards.h"
#include "viewer/stream/shard_map.h"

namespace gigabake {

/// What is around a voxel, and the box for which that holds.
struct QueryPlace {
  enum class Kind {
    nothing,
    shard,
    lost,
    unknown  ///< `page` must be read before
  };
  Kind kind = Kind::nothing;
  std::uint32_t shard = 0;  ///< its number, as NumberedShards counts; of a lost cell, that of lost_name()
  kernels::VoxelBox box{};
  PageKey page{};
};

class QueryPlaces {
 public:
  /// Borrows `numbers` and the pool. page_bytes: of the scene's pages in memory.
  /// Cost    Of a scene that hangs from one root what scene.xml holds. Of others every page is read, and some 40 bytes
  ///         a cell are kept.
  /// Errors  InputError as lay_out_cells().
  QueryPlaces(NumberedShards& numbers, std::uint64_t page_bytes, const ThreadPool& pool);

  /// Levels that can be asked for: those of the cells, and with parents theirs. Where a cell is lost the parents are
  /// left out, since they say nothing of it.
  int lods() const { return lods_; }
  /// Around all cells, lost ones too.
  const kernels::VoxelBox& window() const { return window_; }

  /// Any number of threads at once, beside nothing else. Range  lod < lods().
  QueryPlace find(int lod, const std::int64_t v[3]) const;

  /// Reads pages that find() named. At least the first of them is in memory at the next pass of the rays.
  /// Errors  InputError: a page that cannot be read.
  void read(const std::vector<PageKey>& pages);
  std::uint64_t pages_read() const { return pager_ ? pager_->counts().reads : 0; }

  bool is_lost(std::uint32_t shard) const { return shard >= first_lost_; }
  const std::string& lost_name(std::uint32_t shard) const { return lost_[shard - first_lost_]; }

 private:
  void lay_out(const PagedScene& scene, const ThreadPool& pool);
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
  std::exception_ptr unreadable_;  ///< why a page cannot be read
  std::optional<ShardMap> map_;    ///< of a scene that hangs from one root, and
  std::unique_ptr<Pager> pager_;   ///< its pages; destroyed first, since its threads call read_page()
};

}  // namespace gigabake
