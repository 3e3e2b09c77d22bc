#include "viewer/stream/scene_stream.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"

namespace gigabake {
namespace {

using kernels::RequestKind;

/// The number of requests that are answered in parallel before the clock is checked and the pools are filled. It is
/// large enough to outweigh the start of the threads, and small enough to take less than 2 ms.
constexpr std::size_t requests_per_thread = 128, min_requests_per_batch = 256;
/// The maximum number of requests answered per call, the most urgent first.
constexpr std::size_t max_requests = 8192;
/// The number of waiting requests that are answered again in each call if pages may be evicted. Otherwise the pages
/// that a request needs could evict each other, because only an answer marks them as used.
constexpr std::size_t repeated_requests = 1024;
constexpr std::uint32_t min_slots = 16;
/// The assumed average number of parts of a surface brick: its voxels, including the border, and its layers. If the
/// average is higher, the voxel pool is full before the slots are.
constexpr std::uint32_t parts_per_slot = 90;
/// The factor on the urgency of a root whose cell no ray has hit yet.
constexpr double unseen_root = 1.0 / 64;
constexpr int cpu_tile_edge = 128, device_tile_edge = 1024;
static_assert(cpu_tile_edge % kernels::light_region == 0 && device_tile_edge % kernels::light_region == 0,
              "pixels share shadow samples within regions: tiles must not cut these");

std::size_t requests_per_batch(const ThreadPool& policy) {
  return std::max(min_requests_per_batch, requests_per_thread * std::size_t(policy.threads()));
}

std::uint32_t node_of(std::uint32_t request) { return request / 2; }
RequestKind kind_of_request(std::uint32_t request) { return RequestKind(request % 2); }

/// The rank of a request that needs no answer.
constexpr std::uint64_t no_rank = ~std::uint64_t(0);

/// Returns a sort key; the most urgent request has the smallest key. The bits of positive floats have the order of
/// their values.
std::uint64_t ranked_request(double urgency, std::uint32_t request) {
  return std::uint64_t(~std::bit_cast<std::uint32_t>(float(urgency))) << 32 | request;
}

std::uint32_t request_of(std::uint64_t rank) { return std::uint32_t(rank); }

/// Removes all but the smallest `count` elements.
void keep_min(std::vector<std::uint64_t>& ranks, std::size_t count) {
  if (ranks.size() <= count) return;
  std::nth_element(ranks.begin(), ranks.begin() + std::ptrdiff_t(count), ranks.end());
  ranks.resize(count);
}

std::uint64_t host_memory() { return host_limits().memory_bytes; }

/// Returns the size of the pools. On the host, pools take two thirds of the memory, because a brick in the pools takes
/// about twice its size in a page.
std::uint64_t bytes_for_pools(const SceneStream::Options& options) {
  return options.cuda_device ? options.device_bytes : std::min(options.memory_bytes, host_memory() / 2) / 3 * 2;
}

std::uint64_t bytes_for_pages(const SceneStream::Options& options) {
  const std::uint64_t bytes = std::min(options.memory_bytes, host_memory() / 2);
  return options.cuda_device ? bytes : bytes / 3;
}

kernels::PoolSizes pool_sizes(const CellLayout& layout, std::uint64_t bytes) {
  const std::uint32_t minimum = PoolAllocator::min_tiles(layout.cells.size(), layout.scene.lods);
  const kernels::PoolSizes first{minimum, min_slots, min_slots * kernels::max_parts};
  const std::uint64_t one = kernels::PoolSizes{1, 2, 2 * parts_per_slot}.bytes(), roots = first.bytes();
  if (roots > bytes)
    throw UsageError("memory_bytes", "the roots of " + pluralize(layout.cells.size(), "tree") + " need at least " +
                                         std::to_string(roots / 2 * 3 / 1024 + 1) + "K");
  // The limit of 2^24 keeps all indices below 2^32.
  const auto more = std::uint32_t(std::min<std::uint64_t>((bytes - roots) / one, 1u << 24));
  return {first.tiles + more, first.slots + 2 * more, first.voxels + 2 * parts_per_slot * more};
}

/// Returns the numbers of cells in the order of the scene.
std::vector<std::uint32_t> numbers_of(const std::vector<SceneCell>& cells, const ShardNumbers& numbers) {
  if (!numbers.cells.empty()) return numbers.cells;
  std::vector<std::uint32_t> out;
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) out.push_back(numbers.of_paged(cell));
  return out;
}

void set_leaves(const SceneHeader& header, CellLayout& layout) {
  layout.leaf_lod = int(header.leaf_lod);
  layout.scene.has_leaves = header.leaf_lod != 0;
}

std::unique_ptr<kernels::Caster> make_caster(const CellLayout& layout, const kernels::PoolSizes& sizes,
                                             const SceneStream::Options& options, const ThreadPool& policy) {
  return options.cuda_device ? kernels::make_cuda_caster(layout.scene, sizes, *options.cuda_device, policy)
                             : kernels::make_cpu_caster(layout.scene, sizes, policy);
}

}  // namespace

struct SceneStream::Answer {
  MissingPages missing_pages;
  ChildMasks children;
  bool is_empty = false;
};

SceneStream::Opened SceneStream::open(const PagedScene& scene, const Options& options, const ThreadPool& policy,
                                      const ShardNumbers* numbers) {
  std::optional<OverviewLevels> levels;
  if (!options.cells_alone) levels = overview_levels(scene);
  if (!levels) {
    const std::vector<SceneCell> cells = scene.cells(policy);
    CellLayout layout = lay_out_cells(cells, scene.file());
    set_leaves(scene.header(), layout);
    return {std::move(layout), numbers != nullptr ? ShardMap(cells, numbers_of(cells, *numbers)) : ShardMap(cells)};
  }
  CellLayout layout = lay_out_root(scene.root().overviews[levels->root], scene.totals().window);
  set_leaves(scene.header(), layout);
  if (numbers != nullptr) return {std::move(layout), ShardMap(scene, std::move(*levels), *numbers)};
  return {std::move(layout), ShardMap(scene, std::move(*levels))};
}

SceneStream::SceneStream(const PagedScene& scene, PageSource source, const Options& options, const ThreadPool& policy,
                         const ShardNumbers* numbers)
    : SceneStream(scene, open(scene, options, policy, numbers), std::move(source), options, policy) {}

SceneStream::SceneStream(const PagedScene& scene, Opened opened, PageSource source, const Options& options,
                         const ThreadPool& policy)
    : policy_(policy),
      page_bytes_(bytes_for_pages(options)),
      pool_bytes_(0),
      tile_edge_(options.cuda_device ? device_tile_edge : cpu_tile_edge),
      casts_on_host_(!options.cuda_device),
      cells_alone_(options.cells_alone),
      layout_(std::move(opened.layout)),
      map_(std::move(opened.map)),
      shading_(options.light, scene.header(), options.surface),
      pager_(std::move(source), {options.page_threads, page_bytes_}),
      lookup_(map_, pager_),
      allocator_(layout_.cells.size(), layout_.scene.lods, pool_sizes(layout_, bytes_for_pools(options))) {
  layout_.scene.light = options.light;
  layout_.scene.is_lit =
      options.surface == Surface::colour && scene.header().has_normals && depends_on_normal(options.light);
  const kernels::PoolSizes sizes = pool_sizes(layout_, bytes_for_pools(options));
  pool_bytes_ = sizes.bytes();
  caster_ = make_caster(layout_, sizes, options, policy);
  new_bricks_.reserve(requests_per_batch(policy));
}

void SceneStream::request_roots() {
  if (requests_roots_ || !allocator_.roots_stay()) return;
  requests_roots_ = true;
  for (std::uint32_t root = 0; root < layout_.cells.size(); ++root)
    pending_roots_.push_back(2 * root + std::uint32_t(RequestKind::brick));
  remove_loaded_roots();
}

/// Returns whether the request has been answered.
bool SceneStream::is_fulfilled(std::uint32_t request) const {
  const kernels::CastNode& node = allocator_.node(node_of(request));
  return (kind_of_request(request) == RequestKind::brick ? node.brick : node.children) != kernels::not_resident_ref;
}

/// Returns whether the request is still to be answered. A request is obsolete once its node was evicted.
bool SceneStream::is_open(std::uint32_t request) const {
  return allocator_.is_in_use(node_of(request)) && !is_fulfilled(request);
}

std::size_t SceneStream::open_requests(const std::vector<std::uint32_t>& requests) const {
  return std::size_t(std::ranges::count_if(requests, [&](std::uint32_t request) { return is_open(request); }));
}

/// Returns the squared apparent size of the node: near and coarse nodes cover the most pixels.
double SceneStream::urgency(std::uint32_t request, const Vec3d& eye) const {
  const kernels::VoxelBox box = box_of(allocator_.place_of(node_of(request)), layout_);
  double squared = 1;
  for (int a = 0; a < 3; ++a) {
    const double to_middle = (double(box.min[a]) + double(box.max[a])) / 2 - eye[a];
    squared += to_middle * to_middle;
  }
  const double edge = double(box.max[0] - box.min[0]);
  return edge * edge / squared;
}

/// Returns the ranks of the requests that may have an answer now, most urgent first: requests of rays, and pending
/// roots with a reduced urgency. Tells waiting_ which requests still wait.
std::vector<std::uint64_t> SceneStream::ranks_to_answer(const std::vector<std::uint32_t>& requested, const Vec3d& eye) {
  waiting_.begin_pass(pager_);
  const std::size_t count = requested.size() + pending_roots_.size();
  const bool repeats = pager_.is_nearly_full();
  std::vector<std::uint64_t> ranks(count, no_rank), waiting(repeats ? count : 0, no_rank);
  policy_.parallel_for(count, 2048, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool is_seen = i < requested.size();
      const std::uint32_t request = is_seen ? requested[i] : pending_roots_[i - requested.size()];
      if (!is_open(request)) continue;
      const std::uint64_t rank = ranked_request(urgency(request, eye) * (is_seen ? 1 : unseen_root), request);
      if (!waiting_.waits(request, rank))
        ranks[i] = rank;
      else if (repeats)
        waiting[i] = rank;
    }
  });
  std::erase(waiting, no_rank);
  keep_min(waiting, repeated_requests);
  std::erase(ranks, no_rank);
  ranks.insert(ranks.end(), waiting.begin(), waiting.end());
  keep_min(ranks, max_requests);
  std::sort(ranks.begin(), ranks.end());
  return ranks;
}

void SceneStream::remove_loaded_roots() {
  std::erase_if(pending_roots_, [&](std::uint32_t request) { return is_fulfilled(request); });
}

void SceneStream::answer(std::uint32_t request, Answer& out, kernels::CastBrick& brick) const {
  const FieldNode node = allocator_.place_of(node_of(request));
  out.missing_pages.own = box_of(node, layout_);
  if (kind_of_request(request) == RequestKind::children)
    out.children = children_of(node, layout_, lookup_, out.missing_pages);
  else
    out.is_empty = !fill_brick(node, layout_, lookup_, shading_, out.missing_pages, brick);
  // If an overview is unreadable, an empty brick does not prove that finer levels are empty.
  out.missing_pages.damaged |= out.is_empty && out.missing_pages.is_overview_damaged;
}

/// Enters the answer into the pools; returns false if the pool is full.
bool SceneStream::enter(std::uint32_t request, const Answer& answer, kernels::CastBrick& brick) {
  const std::uint32_t node = node_of(request);
  if (answer.missing_pages.damaged) {
    allocator_.set_lost(node, kind_of_request(request));
  } else if (kind_of_request(request) == RequestKind::children) {
    if (!allocator_.put_children(node, answer.children, *caster_)) return false;
  } else if (answer.is_empty) {
    allocator_.set_empty(node);
  } else {
    const std::optional<std::uint32_t> slot = allocator_.put_brick(node, std::uint32_t(brick.parts.size()), *caster_);
    if (!slot) return false;
    new_slots_.push_back(*slot);
    new_bricks_.push_back(std::move(brick));
  }
  return true;
}

SceneStream::Served SceneStream::serve(const std::vector<std::uint32_t>& requested, const Vec3d& eye,
                                       const kernels::StopAsked& enough, const Keep& keep) {
  Served served;
  const std::vector<std::uint64_t> ranks = ranks_to_answer(requested, eye);
  std::vector<Answer> answers;
  const std::size_t per_batch = requests_per_batch(policy_);
  std::vector<kernels::CastBrick> bricks(std::min(ranks.size(), per_batch));
  allocator_.begin_round(keep.used_since, !keep.all);
  for (std::size_t from = 0; from < ranks.size() && !served.is_full; from += per_batch) {
    if (from != 0 && enough && enough()) break;
    const std::size_t count = std::min(ranks.size() - from, per_batch);
    answers.assign(count, {});
    policy_.parallel_for(count, 8, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) answer(request_of(ranks[from + i]), answers[i], bricks[i]);
    });
    served.answers += count;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t request = request_of(ranks[from + i]);
      if (!answers[i].missing_pages.missing.empty())
        waiting_.add(request, ranks[from + i], std::move(answers[i].missing_pages.missing));
      else if (served.is_full || !allocator_.is_settled(node_of(request)) || is_fulfilled(request))
        continue;
      else if (enter(request, answers[i], bricks[i]))
        ++served.uploads;
      else
        served.is_full = true;
    }
    std::vector<kernels::BrickPlace> places;
    for (const std::uint32_t slot : new_slots_) places.push_back(allocator_.brick_place(slot));
    for (const kernels::CastBrick& brick : new_bricks_)
      uploaded_bytes_ += sizeof(brick.head) + sizeof(kernels::PackedVoxel) * brick.parts.size();
    caster_->put_bricks(places, new_bricks_);
    new_slots_.clear();
    new_bricks_.clear();
  }
  const auto changes = allocator_.take_changes();
  uploaded_bytes_ += sizeof(kernels::NodeChange) * changes.size();
  caster_->put_nodes(changes);
  std::vector<PageKey> missing = waiting_.pages_by_urgency();
  served.misses_pages = !missing.empty();
  missing.insert(missing.end(), exchange_missing_.begin(), exchange_missing_.end());
  pager_.request(missing);
  remove_loaded_roots();
  served.evicted_used = allocator_.evicted_used();
  uploads_ += served.uploads;
  return served;
}

bool SceneStream::has_layout_of(const PagedScene& next) const {
  Options options;
  options.cells_alone = cells_alone_;
  const CellLayout layout = open(next, options, policy_, nullptr).layout;
  const auto min_of = [](const kernels::CastCell& cell) { return cell.min; };
  return layout.leaf_lod == layout_.leaf_lod && layout.scene.min == layout_.scene.min &&
         layout.scene.max == layout_.scene.max && layout.scene.cell_bits == layout_.scene.cell_bits &&
         layout.column_key == layout_.column_key && layout.column_first == layout_.column_first &&
         std::ranges::equal(layout.cells, layout_.cells, {}, min_of, min_of);
}

void SceneStream::begin_exchange(const PagedScene& next, const ShardNumbers& numbers, std::vector<Box3i64> changed) {
  Options options;
  options.cells_alone = cells_alone_;
  exchange_missing_.clear();
  exchange_.emplace(open(next, options, policy_, &numbers).map, std::move(changed), allocator_, layout_);
}

bool SceneStream::advance_exchange(const kernels::StopAsked& enough) {
  pager_.begin_pass();
  exchange_missing_.clear();
  if (!exchange_->prepare(pager_, shading_, policy_, enough, exchange_missing_)) {
    pager_.request(exchange_missing_);
    return false;
  }
  uploads_ += exchange_->enter(*caster_);
  map_ = exchange_->take_map();
  waiting_.clear();  // its pages belong to the previous map
  exchange_.reset();
  return true;
}

}  // namespace gigabake
