/// Pages, the unit of streaming. A page is a block of node rows of a shard, or a block of bricks of one level, or a
/// *listing*. A listing is the content of one scene page: cells, overviews and further scene pages. Node rows and
/// bricks are stored in Morton order. A block therefore covers a compact part of the shard, and a whole tree never has
/// to be resident.
#pragma once

#include <atomic>
#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/math/vec3.h"
#include "format/scene/paged_scene.h"
#include "format/shard/shard.h"

namespace gigabake {

inline constexpr std::uint32_t nodes_per_block = 4096, bricks_per_block = 512;

/// The identity of a page. Cells are numbered from 0 in the order of the scene's pages; the numbers of overviews
/// follow. The overviews of a page come before the overviews of the pages below it.
struct PageKey {
  std::uint32_t shard = 0;  ///< shard number; for a listing: the number of its first cell
  std::int32_t part = -1;   ///< node_rows; listing or less; otherwise the level of the bricks, counted from the
                            ///< shard's finest level
  std::uint32_t block = 0;  ///< first row: block · nodes_per_block; first brick: block · bricks_per_block

  static constexpr std::int32_t node_rows = -1;
  /// The value for the listing of a page to which scene.xml refers directly. Each further reference on the path from
  /// scene.xml to a page decreases the value by 1.
  static constexpr std::int32_t listing = -2;

  friend bool operator==(const PageKey&, const PageKey&) = default;  // nvcc 13 does not define the implied operator
  friend auto operator<=>(const PageKey&, const PageKey&) = default;
};

struct ListedCell {
  Vec3i64 min{};
  std::uint32_t number = 0;
};

struct ListedOverview {
  std::uint32_t own_lod = 0;
  Vec3i64 min{};
  std::uint32_t index = 0;  ///< shard number minus the number of cells
};

struct ListedPage {
  LatticeBlock block;
  std::uint32_t first_cell = 0;
};

/// The use of a page by the page pool of a caster (pooled_pages.h). One thread at a time reads and changes it.
struct PagePoolMark {
  std::uint64_t position = 0;  ///< of the page's voxels in the pool; 0: never in the pool
  std::uint32_t uses = 0;      ///< bricks that needed the page while it was not in the pool
};

struct Page {
  std::vector<NodeRow> rows;      ///< in a page of node rows
  BrickBlock bricks;              ///< in a page of bricks (format/shard/shard.h)
  std::vector<ListedCell> cells;  ///< in a listing; sorted by min x, y, z
  std::vector<ListedPage> pages;
  std::vector<ListedOverview> overviews;  ///< in a listing; sorted by own_lod, then by min x, y, z

  mutable PagePoolMark pool_mark;  ///< in a page of bricks; not part of the content

  std::uint64_t bytes() const;  ///< memory use
};

/// A function that reads one page. Several threads call it concurrently.
/// Exact   The children of a row exist and follow the row in the table. Masks, `first` and the columns agree.
/// Errors  InputError: no such shard, a damaged shard, a shard of another scene, or no such block.
using PageSource = std::function<Page(const PageKey&)>;

/// Returns the cells, sorted by min x, y, z for searches. `first` is the shard number of cells[0].
std::vector<ListedCell> listed_cells(const std::vector<SceneCell>& cells, std::uint32_t first);
std::vector<ListedPage> listed_pages(const std::vector<PageReference>& pages, std::uint32_t first);
std::vector<ListedOverview> listed_overviews(const std::vector<SceneCell>& overviews, std::uint32_t first);

/// The maximum number of open shards; beyond it the least recently used shard is closed. The usual limit of a process
/// is 1024 open files.
inline constexpr std::size_t max_open_shards = 400;

/// Returns a source that reads the scene's pages and shards. Counts each opened file in `files_opened`; null: not
/// counted.
PageSource pages_from_files(std::shared_ptr<const PagedScene> scene,
                            std::shared_ptr<std::atomic<std::uint64_t>> files_opened = {});

/// Limits for the pages of an external producer.
struct ProducerLimits {
  double seconds = 30;                                      ///< time limit of a page; 0: no limit
  int max_late = 3;                                         ///< limit of late pages; then no page is requested
  std::uint64_t max_page_bytes = std::uint64_t(256) << 20;  ///< limit of Page::bytes()
};

/// Returns a source that calls the producer and validates its pages. Each request returns a consistent page or throws
/// an error with the reason, within the time limit. If there is a time limit, each call of the producer runs in a
/// separate thread.
/// A late call continues in its thread and its page is discarded, so everything that the producer uses must outlive the
/// call. The producer is called concurrently, also on threads other than the callers of the returned source.
/// Errors  InputError, from the returned source: the producer threw, is late, or returned a wrong page. A page is wrong
///         if it exceeds the size limit, has another type than the key, is inconsistent, or lacks the scene's normals.
PageSource guarded_pages(PageSource producer, const SceneHeader& scene, const ProducerLimits& limits = {});

}  // namespace gigabake
