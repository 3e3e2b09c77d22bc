/// Answers to the requests of rays: the children or the brick of a node, built from resident pages.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/render/caster.h"
#include "viewer/light/shading.h"
#include "viewer/stream/brick_fill.h"
#include "viewer/stream/pool_allocator.h"
#include "viewer/stream/requests/pooled_pages.h"
#include "viewer/stream/requests/waiting_requests.h"
#include "viewer/stream/voxel_lookup.h"

namespace gigabake {

/// A request of rays (Caster::requested()).
struct NodeRequest {
  std::uint32_t node = 0;
  kernels::RequestKind kind{};

  explicit NodeRequest(std::uint32_t request) : node(request / 2), kind(kernels::RequestKind(request % 2)) {}
};

/// The answer to one request. Except for `pages`, it is independent of pages, which may be evicted afterwards.
struct RequestAnswer {
  std::uint32_t request = 0;
  bool is_missing = false;  ///< the request waits for pages, or its pass was stopped; the other members are not set
  bool is_damaged = false;  ///< pages that the answer needs cannot be read
  ChildMasks children;      ///< of a request of children
  bool is_empty = false;    ///< of a request of a brick: there are no voxels
  std::unique_ptr<kernels::CastBrick> brick;  ///< filled for a request of a brick that is not empty
  BrickPages pages = {};                      ///< of the brick's runs, valid until the pager's next pass
};

/// Requests in the order of their urgency, answered in batches on all threads. Requests whose pages are not resident
/// wait (waiting_requests.h).
class RequestAnswers {
 public:
  /// Borrows all arguments.
  RequestAnswers(const CellLayout& layout, const Shading& shading, const PoolAllocator& allocator, const Pager& pager,
                 const VoxelLookup& lookup, PooledPages& pooled_pages, const ThreadPool& policy);

  /// Returns whether the request was answered before.
  bool is_fulfilled(std::uint32_t request) const;
  /// Returns whether the request is still to be answered. A request is obsolete once its node was evicted.
  bool is_open(std::uint32_t request) const;

  /// Begins a pass with new requests. Near and coarse nodes are the most urgent; `eye` is in lod-0 voxels. The urgency
  /// of `roots` is reduced, because no ray has reached them. Ignores requests that were answered, and requests whose
  /// pages are still missing. Once `stop` becomes true, the other answers of the running batch are missing, and their
  /// requests are not answered in this pass. The first batch is always answered.
  void begin_pass(std::span<const std::uint32_t> requested, std::span<const std::uint32_t> roots, const Vec3d& eye,
                  const std::atomic<bool>* stop = nullptr);
  /// Returns whether next_batch() has requests to answer. A pass answers at most some thousand requests.
  bool has_next() const { return next_ < ranks_.size(); }
  /// Answers the next requests, for the places that their nodes had in begin_pass(). The result is valid until the next
  /// call, and the caller may move from it. Bricks have runs only if the caster has a page pool, and their pages have
  /// places in the pool (pooled_pages.h). Other threads begin with the batch after it if `works_ahead` is true, while
  /// the caller uses the result.
  std::span<RequestAnswer> next_batch(bool works_ahead);
  /// Returns whether a batch was begun ahead.
  bool has_begun_next() const { return running_.has_value(); }
  /// Drops a batch that was begun ahead. Call it before the pager's next pass.
  void end_pass();
  /// Takes bricks that are not needed any more. Answers use their memory again.
  void reuse(kernels::CastBricks bricks);

  /// Returns the pages that requests of this pass lack, most urgent first. A page may occur several times.
  std::vector<PageKey> missing_pages() const { return waiting_.pages_by_urgency(); }
  /// Forgets which pages requests lack, after the pages of the scene have changed.
  void forget_pages() { waiting_.clear(); }

 private:
  /// A request and its node. Threads that answer it do not read the allocator, which the caller changes.
  struct Wanted {
    std::uint32_t request = 0;
    FieldNode node;
  };
  /// Requests that are answered in one loop, and their answers.
  struct Batch {
    std::size_t first = 0, count = 0;  ///< of ranks_
    std::vector<RequestAnswer> answers;
    std::vector<MissingPages> missing_pages;  ///< of each answer
    kernels::CastBricks spare;                ///< bricks whose memory new answers use
    std::atomic<std::size_t> taken{0};        ///< of `spare`, from its end
  };

  double urgency(const FieldNode& node, const Vec3d& eye) const;
  void begin_batch();
  void answer(Batch& batch, std::size_t i, LookupCache& cache) const;
  void answer(RequestAnswer& answer, const FieldNode& node, LookupCache& cache, MissingPages& missing_pages) const;
  void place_runs(std::span<RequestAnswer> answers);

  const CellLayout& layout_;
  const Shading& shading_;
  const PoolAllocator& allocator_;
  const Pager& pager_;
  const VoxelLookup& lookup_;
  PooledPages& pooled_pages_;
  const ThreadPool& policy_;
  WaitingRequests waiting_;
  std::vector<std::uint64_t> ranks_;  ///< most urgent first
  std::vector<Wanted> wanted_;        ///< all requests of the pass, at the places that ranks_ name
  std::size_t next_ = 0;              ///< of ranks_, after the batches that next_batch() has returned
  std::array<Batch, 2> batches_;      ///< two if the caller works ahead, otherwise one
  std::size_t latest_ = 0;            ///< of batches_
  std::vector<LookupCache> caches_;   ///< by thread
  kernels::CastBricks spare_;
  const std::atomic<bool>* stop_ = nullptr;
  std::optional<ThreadPool::Running> running_;  ///< answers the batch from next_ on; declared last, so it ends first
};

}  // namespace gigabake
