/// Streaming of a scene larger than memory to the ray caster. Reads the pages that rays request, fills bricks and puts
/// them into the pools, the most urgent bricks first. If one root overview covers the scene, a few trees of its size
/// cover all cells. Cells are then looked up when rays descend to them. Otherwise each cell has a tree.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/scene/paged_scene.h"
#include "kernels/render/caster.h"
#include "viewer/light/shading.h"
#include "viewer/stream/cell_layout.h"
#include "viewer/stream/exchange/scene_exchange.h"
#include "viewer/stream/pager.h"
#include "viewer/stream/pool_allocator.h"
#include "viewer/stream/requests/pooled_pages.h"
#include "viewer/stream/requests/request_answers.h"
#include "viewer/stream/shard_map.h"
#include "viewer/stream/voxel_lookup.h"

namespace gigabake {

class SceneStream {
 public:
  struct Options {
    kernels::CastLight light;
    Surface surface = Surface::colour;
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  ///< pools and pages; at most half of the host's memory
    int page_threads = 2;
    std::optional<int> cuda_device;  ///< ordinal of cuda_devices() to cast on; memory_bytes then excludes the pools
    std::uint64_t device_bytes = std::uint64_t(4) << 30;  ///< size of the device's pools, including the page pool
    bool cells_alone = false;                             ///< ignores overviews, so that each cell has a tree
    std::optional<std::uint64_t> page_pool_bytes;         ///< of the pools, at most half of them; null: a quarter of a
                                                          ///< device's pools, none on the host (pooled_pages.h)
  };

  /// The eviction rule of the pools for entries that rays used in pass `used_since` or later. If `all`, these entries
  /// are never evicted. Otherwise they are evicted only if nothing else can be evicted.
  struct Keep {
    std::uint32_t used_since = 0;
    bool all = true;
  };

  /// Result of one call of serve().
  struct Served {
    std::uint64_t answers = 0;  ///< requests that were examined, also if they miss pages
    std::uint64_t uploads = 0;
    bool misses_pages = false;  ///< requests wait for pages, which the pager reads now
    bool evicted_used = false;  ///< evicted entries that rays used since Keep::used_since
    bool is_full = false;       ///< a request was dropped, because everything in the pools is in use
  };

  /// Borrows `policy`. `numbers` are the shards' numbers in the keys of pages; null: the order of the scene.
  /// Errors  InputError: the errors of lay_out_cells(). UsageError: less memory than the scene's roots need.
  ///         CudaFailure, also from all members that use the caster.
  SceneStream(const PagedScene& scene, PageSource source, const Options& options, const ThreadPool& policy,
              const ShardNumbers* numbers = nullptr);

  kernels::Caster& caster() { return *caster_; }
  const CellLayout& layout() const { return layout_; }

  /// Enters prepared answers. If there are none, answers the requests of rays (Caster::requested()) whose pages are
  /// resident, until `enough` returns true, but at least one batch. Skips requests that were answered since, and
  /// requests whose pages are still missing. Requests all missing pages from the pager. Near and coarse nodes come
  /// first; `eye` is in lod-0 voxels.
  Served serve(const std::vector<std::uint32_t>& requested, const Vec3d& eye, const kernels::StopAsked& enough,
               const Keep& keep);

  /// Begins to answer requests on other threads, at least one batch, unless answers still wait for their entry. Also
  /// allocates their places in the pools, as long as nothing has to be evicted, and copies the new bricks to the
  /// caster. The next serve() ends this and copies the new nodes. Meant for the time in which a GPU casts.
  void prepare(const std::vector<std::uint32_t>& requested, const Vec3d& eye);

  /// Returns the number of bricks and node tiles that prepare() has put into the pools since the last serve().
  /// Range   prepare() has ended: begin_pass() was called after it.
  std::uint64_t prepared_uploads() const { return prepared_work_.uploads; }

  /// Returns how many of the requests were not answered yet.
  std::size_t open_requests(const std::vector<std::uint32_t>& requests) const;

  /// Makes pages resident that were read since the last call.
  void begin_pass();
  /// Waits until something was read, or nothing is being read. Returns false on timeout.
  bool wait(std::chrono::milliseconds maximum) { return pager_.wait(maximum); }
  /// Waits until nothing is being read. Returns false on timeout.
  bool settle(std::chrono::milliseconds maximum) { return pager_.settle(maximum); }
  bool has_loaded_pages() const { return pager_.has_loaded_pages(); }

  /// Begins to exchange the contents of the boxes `changed` (lod-0 voxels) for the contents of another scene with the
  /// same layout. Until the end, images show the previous contents. Replaces an exchange in progress.
  /// Range   `changed` includes all voxels in which the next scene differs from the shown scene.
  void begin_exchange(const PagedScene& next, const ShardNumbers& numbers, std::vector<Box3i64> changed);
  bool has_exchange() const { return exchange_.has_value(); }
  /// Returns whether the scene has the layout of this stream, so that it can be exchanged.
  bool has_layout_of(const PagedScene& next) const;
  /// Continues the exchange until `enough` returns true. Returns true once the new contents are in the pools.
  bool advance_exchange(const kernels::StopAsked& enough);

  /// Makes each later serve() also load the bricks of the roots, requested or not, if the pools can hold all of them.
  /// Then every view has a coarse fallback for the whole scene.
  void request_roots();
  /// Returns whether some of the roots are not resident yet.
  bool has_pending_roots() const { return !pending_roots_.empty(); }

  /// Returns the edge of a render tile in pixels. It is large enough to share page requests and to fill a GPU, and
  /// small enough to bound memory and cancellation latency.
  int tile_edge() const { return tile_edge_; }
  /// Returns whether the CPU casts the rays.
  bool casts_on_host() const { return casts_on_host_; }

  /// Returns the size of the pools, on host or device, plus the memory limit of the pages.
  std::uint64_t bytes_allowed() const { return pool_bytes_ + page_bytes_; }
  /// Returns the bytes that pools and pages use; pools as of the end of the last serve().
  std::uint64_t bytes_held() const { return pool_bytes_held_ + pager_.counts().bytes; }
  std::uint64_t page_bytes_allowed() const { return page_bytes_; }
  PagerCounts page_counts() const { return pager_.counts(); }
  std::uint64_t uploads() const { return uploads_; }                ///< bricks and node tiles put into the pools so far
  std::uint64_t uploaded_bytes() const { return uploaded_bytes_; }  ///< bytes that serve() put into the pools so far
  /// Returns one line per page that could not be read.
  std::vector<std::string> problems() const { return pager_.problems(); }

 private:
  struct Opened {
    CellLayout layout;
    ShardMap map;
  };
  static Opened open(const PagedScene& scene, const Options& options, const ThreadPool& policy,
                     const ShardNumbers* numbers);
  SceneStream(const PagedScene& scene, Opened opened, PageSource source, const Options& options,
              const ThreadPool& policy);

  /// Pages and bricks for the caster.
  struct NewData {
    std::vector<kernels::PageUpload> pages;
    std::vector<kernels::BrickPlace> places;
    kernels::CastBricks bricks;
  };

  void answer_ahead(const std::vector<std::uint32_t>& requested, const Vec3d& eye);
  void finish_preparing();
  bool request_missing_pages();
  bool enter(RequestAnswer& answer);
  std::size_t enter_without_evictions(std::span<RequestAnswer> answers);
  void enter_prepared(const kernels::StopAsked& enough, Served& served);
  void forget_prepared();
  std::size_t enter_some(std::span<RequestAnswer> answers, std::uint32_t round, const kernels::StopAsked& enough,
                         Served& served);
  NewData take_new_data();
  std::uint64_t put(const NewData& data);
  void put_new_bricks();
  void put_changed_nodes();
  void remove_loaded_roots();

  const ThreadPool& policy_;
  std::uint64_t page_bytes_, pool_bytes_, pool_bytes_held_ = 0;
  int tile_edge_;
  bool casts_on_host_;
  bool cells_alone_;
  CellLayout layout_;
  ShardMap map_;
  Shading shading_;
  Pager pager_;
  VoxelLookup lookup_;
  kernels::PagePoolSize page_pool_size_;
  PoolAllocator allocator_;
  PooledPages pooled_pages_;
  RequestAnswers answers_;
  std::unique_ptr<kernels::Caster> caster_;
  bool requests_roots_ = false;
  std::vector<std::uint32_t> pending_roots_;  ///< requests of root bricks
  std::vector<std::uint32_t> new_slots_;
  kernels::CastBricks new_bricks_;
  std::uint64_t uploads_ = 0, uploaded_bytes_ = 0;
  std::uint64_t put_bytes_ = 0;  ///< bytes put into the pools since the last serve()
  std::optional<SceneExchange> exchange_;
  std::vector<PageKey> exchange_missing_;  ///< pages for which the exchange waits
  Served prepared_work_;                   ///< of prepare() since the last serve()
  std::vector<RequestAnswer> prepared_;    ///< answers that need evictions; the first entered_ are entered
  std::size_t entered_ = 0;
  std::uint32_t prepared_round_ = 0;  ///< round of the allocator before the answers were prepared
  std::atomic<bool> stops_preparing_{false};
  /// The answers in progress: other members must not be changed until they end. Destroyed first, which waits for them.
  std::future<void> preparing_;
};

}  // namespace gigabake
