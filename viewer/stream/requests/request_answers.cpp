#include "viewer/stream/requests/request_answers.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <iterator>
#include <numeric>
#include <utility>

namespace gigabake {
namespace {

using kernels::CastBricks;
using kernels::RequestKind;

/// The number of requests that are answered in parallel before the clock is checked and the pools are filled. It is
/// large enough to outweigh the start of the threads, and small enough to take less than 2 ms.
constexpr std::size_t requests_per_thread = 128, min_batch = 512;
/// The maximum number of requests answered per pass, the most urgent first.
constexpr std::size_t max_requests = 32768;
/// The number of waiting requests that are answered again in each pass if pages may be evicted. Otherwise the pages
/// that a request needs could evict each other, because only an answer marks them as used.
constexpr std::size_t repeated_requests = 1024;
/// The factor on the urgency of a root whose cell no ray has hit yet.
constexpr double unseen_root = 1.0 / 64;

/// Removes the contents of a previous answer, except for its request. Keeps the memory: threads that free the memory of
/// other threads wait for each other.
void reset(RequestAnswer& answer, MissingPages& missing_pages) {
  answer.is_missing = answer.is_damaged = answer.is_empty = false;
  answer.children = {};
  answer.pages = {};
  answer.brick->head = {};
  answer.brick->part_count = 0;
  answer.brick->parts.clear();
  answer.brick->runs.clear();
  missing_pages.missing.clear();
  missing_pages.damaged = missing_pages.is_overview_damaged = false;
}

/// The rank of a request that needs no answer.
constexpr std::uint64_t no_rank = ~std::uint64_t(0);

/// Returns a sort key; the most urgent request has the smallest key. The bits of positive floats have the order of
/// their values. `place` identifies the request.
std::uint64_t ranked_request(double urgency, std::size_t place) {
  return std::uint64_t(~std::bit_cast<std::uint32_t>(float(urgency))) << 32 | std::uint32_t(place);
}

/// Sorts the ranks by their urgency to 1/8 of its value. Removes no_rank and all but the first `max_count` ranks.
/// Requests of about equal urgency keep their order. Siblings follow each other in it, and their answers read the same
/// memory. A counting sort: rays can miss some hundred thousand nodes per pass.
void keep_first(std::vector<std::uint64_t>& ranks, std::size_t max_count) {
  constexpr unsigned ignored_bits = 52;  // all but the sign, the exponent and 3 bits of the urgency
  std::vector<std::uint32_t> place((std::size_t(1) << (64 - ignored_bits)) + 1);
  for (const std::uint64_t rank : ranks)
    if (rank != no_rank) ++place[(rank >> ignored_bits) + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  const auto end = std::size_t(std::ranges::lower_bound(place, max_count) - place.begin());  // of the urgent buckets
  std::vector<std::uint64_t> sorted(place[std::min(end, place.size() - 1)]);
  for (const std::uint64_t rank : ranks)
    if (rank >> ignored_bits < end && rank != no_rank) sorted[place[rank >> ignored_bits]++] = rank;
  sorted.resize(std::min(sorted.size(), max_count));
  ranks = std::move(sorted);
}

/// Adds as many of the bricks as a pass can use.
void add_spare(CastBricks& spare, CastBricks bricks) {
  if (bricks.size() > spare.size()) std::swap(bricks, spare);
  const std::size_t count = std::min(bricks.size(), max_requests - std::min(max_requests, spare.size()));
  std::move(bricks.begin(), bricks.begin() + std::ptrdiff_t(count), std::back_inserter(spare));
}

}  // namespace

RequestAnswers::RequestAnswers(const CellLayout& layout, const Shading& shading, const PoolAllocator& allocator,
                               const Pager& pager, const VoxelLookup& lookup, PooledPages& pooled_pages,
                               const ThreadPool& policy)
    : layout_(layout),
      shading_(shading),
      allocator_(allocator),
      pager_(pager),
      lookup_(lookup),
      pooled_pages_(pooled_pages),
      policy_(policy) {}

bool RequestAnswers::is_fulfilled(std::uint32_t request) const {
  const NodeRequest wanted(request);
  const kernels::CastNode& node = allocator_.node(wanted.node);
  return (wanted.kind == RequestKind::brick ? node.brick : node.children) != kernels::not_resident_ref;
}

bool RequestAnswers::is_open(std::uint32_t request) const {
  return allocator_.is_in_use(NodeRequest(request).node) && !is_fulfilled(request);
}

/// Returns the squared apparent size of the node: near and coarse nodes cover the most pixels.
double RequestAnswers::urgency(const FieldNode& node, const Vec3d& eye) const {
  const kernels::VoxelBox box = box_of(node, layout_);
  double squared = 1;
  for (int a = 0; a < 3; ++a) {
    const double to_middle = (double(box.min[a]) + double(box.max[a])) / 2 - eye[a];
    squared += to_middle * to_middle;
  }
  const double edge = double(box.max[0] - box.min[0]);
  return edge * edge / squared;
}

void RequestAnswers::begin_pass(std::span<const std::uint32_t> requested, std::span<const std::uint32_t> roots,
                                const Vec3d& eye, const std::atomic<bool>* stop) {
  end_pass();
  stop_ = stop;
  waiting_.begin_pass(pager_);
  caches_.assign(std::size_t(policy_.threads()), {});
  const std::size_t count = requested.size() + roots.size();
  const bool repeats = pager_.may_evict();
  std::vector<std::uint64_t> waiting(repeats ? count : 0, no_rank);
  ranks_.assign(count, no_rank);
  wanted_.resize(count);
  next_ = 0;
  policy_.parallel_for(count, 2048, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool is_seen = i < requested.size();
      const std::uint32_t request = is_seen ? requested[i] : roots[i - requested.size()];
      if (!is_open(request)) continue;
      const FieldNode node = allocator_.place_of(NodeRequest(request).node);
      wanted_[i] = {request, node};
      const std::uint64_t rank = ranked_request(urgency(node, eye) * (is_seen ? 1 : unseen_root), i);
      if (!waiting_.waits(request, rank))
        ranks_[i] = rank;
      else if (repeats)
        waiting[i] = rank;
    }
  });
  keep_first(waiting, repeated_requests);
  ranks_.insert(ranks_.end(), waiting.begin(), waiting.end());
  keep_first(ranks_, max_requests);
}

/// Sets the answer, which was reset, or the pages that it lacks.
void RequestAnswers::answer(RequestAnswer& answer, const FieldNode& node, LookupCache& cache,
                            MissingPages& missing_pages) const {
  missing_pages.own = box_of(node, layout_);
  missing_pages.found = &cache.pages;
  if (NodeRequest(answer.request).kind == RequestKind::children)
    answer.children = children_of(node, layout_, lookup_, missing_pages);
  else
    answer.is_empty =
        !fill_brick(node, layout_, lookup_, shading_, cache.path, missing_pages, *answer.brick, answer.pages);
  // If an overview is unreadable, an empty brick does not prove that finer levels are empty.
  answer.is_damaged = missing_pages.damaged || (answer.is_empty && missing_pages.is_overview_damaged);
  answer.is_missing = !missing_pages.missing.empty();
  sort_unique(missing_pages.missing);
  if (answer.is_missing)
    answer.brick->runs.clear();
  else if (!pooled_pages_.has_pool())
    copy_runs(shading_, answer.pages, *answer.brick);
}

/// Puts the pages of runs into the page pool. Copies the voxels of bricks whose pages are not put.
void RequestAnswers::place_runs(std::span<RequestAnswer> answers) {
  for (const RequestAnswer& answer : answers)
    if (!answer.brick->runs.empty()) pooled_pages_.count_use(answer.pages);
  std::vector<RequestAnswer*> rest;
  for (RequestAnswer& answer : answers)
    if (!answer.brick->runs.empty() && !pooled_pages_.place(answer.pages, *answer.brick)) rest.push_back(&answer);
  policy_.parallel_for(rest.size(), 8, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) copy_runs(shading_, rest[i]->pages, *rest[i]->brick);
  });
}

void RequestAnswers::reuse(CastBricks bricks) { add_spare(spare_, std::move(bricks)); }

/// Answers request `i` of the batch, unless the pass is stopped.
void RequestAnswers::answer(Batch& batch, std::size_t i, LookupCache& cache) const {
  RequestAnswer& its_answer = batch.answers[i];
  if (!its_answer.brick)
    if (const std::size_t spare = ++batch.taken; spare <= batch.spare.size())
      its_answer.brick = std::move(batch.spare[batch.spare.size() - spare]);
  if (!its_answer.brick) its_answer.brick = std::make_unique<kernels::CastBrick>();
  const Wanted& wanted = wanted_[std::uint32_t(ranks_[batch.first + i])];
  its_answer.request = wanted.request;
  reset(its_answer, batch.missing_pages[i]);
  its_answer.is_missing = batch.first > 0 && stop_ != nullptr && *stop_;
  if (!its_answer.is_missing) answer(its_answer, wanted.node, cache, batch.missing_pages[i]);
}

/// Begins the batch from next_ on.
void RequestAnswers::begin_batch() {
  Batch& batch = batches_[latest_];
  batch.first = next_;
  const std::size_t max_count = std::max(min_batch, requests_per_thread * std::size_t(policy_.threads()));
  batch.count = std::min(ranks_.size() - next_, max_count);
  batch.answers.resize(std::max(batch.answers.size(), batch.count));
  batch.missing_pages.resize(batch.answers.size());
  batch.spare.resize(batch.spare.size() - std::min(batch.taken.exchange(0), batch.spare.size()));
  add_spare(batch.spare, std::exchange(spare_, {}));
  running_.emplace(policy_.start(batch.count, 8, [this, &batch](std::size_t begin, std::size_t end, int thread) {
    for (std::size_t i = begin; i < end; ++i) answer(batch, i, caches_[std::size_t(thread)]);
  }));
}

std::span<RequestAnswer> RequestAnswers::next_batch(bool works_ahead) {
  if (!running_) begin_batch();
  running_->finish();
  running_.reset();
  Batch& batch = batches_[latest_];
  next_ += batch.count;
  if (works_ahead && has_next()) {
    latest_ = 1 - latest_;
    begin_batch();
  }
  const std::span<RequestAnswer> answers(batch.answers.data(), batch.count);
  if (pooled_pages_.has_pool()) place_runs(answers);
  for (std::size_t i = 0; i < answers.size(); ++i)
    if (!batch.missing_pages[i].missing.empty())
      waiting_.add(answers[i].request, ranks_[batch.first + i], batch.missing_pages[i].missing);
  return answers;
}

void RequestAnswers::end_pass() { running_.reset(); }

}  // namespace gigabake
