#include "viewer/stream/scene_stream.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"

namespace gigabake {
namespace {

using kernels::RequestKind;

/// The number of answers that are entered before the clock is checked.
constexpr std::size_t answers_per_check = 64;
constexpr std::uint32_t min_slots = 16;
/// The min size of the pools of a device that have a page pool, if Options::page_pool_bytes does not set its size.
/// Smaller pools need all their memory for bricks.
constexpr std::uint64_t min_bytes_with_page_pool = std::uint64_t(64) << 20;
/// The assumed average number of parts of a surface brick: its voxels, including the border, and its layers. If the
/// average is higher, the voxel pool is full before the slots are.
constexpr std::uint32_t parts_per_slot = 90;
constexpr int cpu_tile_edge = 128, device_tile_edge = 1024;
static_assert(cpu_tile_edge % kernels::light_region == 0 && device_tile_edge % kernels::light_region == 0,
              "pixels share shadow samples within regions: tiles must not cut these");

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

/// Returns the size of the page pool. Its columns are the columns that shading reads.
kernels::PagePoolSize page_pool_size(const SceneStream::Options& options, const SceneHeader& scene,
                                     const Shading& shading) {
  const std::uint64_t pools = bytes_for_pools(options);
  const bool has_pool = options.cuda_device && pools >= min_bytes_with_page_pool;
  const std::uint64_t bytes = std::min(options.page_pool_bytes.value_or(has_pool ? pools / 4 : 0), pools / 2);
  kernels::PagePoolSize size;
  size.has_normals = scene.has_normals;
  size.has_directional_coverage = scene.has_directional_coverage;
  size.has_classes = options.surface == Surface::voxel_class && scene.has_classes;
  size.shading = shading.parameters();
  const std::uint64_t voxels = std::min<std::uint64_t>(bytes / size.bytes_per_voxel(), 1u << 31);
  size.voxels = std::uint32_t(voxels / kernels::page_alignment * kernels::page_alignment);
  return size;
}

/// Returns the sizes of the pools of nodes and bricks, which share their memory with the page pool.
kernels::PoolSizes pool_sizes(const CellLayout& layout, const SceneStream::Options& options,
                              const kernels::PagePoolSize& pages) {
  const std::uint64_t bytes = bytes_for_pools(options) - pages.bytes();
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
                                             const kernels::PagePoolSize& pages, const SceneStream::Options& options,
                                             const ThreadPool& policy) {
  return options.cuda_device ? kernels::make_cuda_caster(layout.scene, sizes, pages, *options.cuda_device, policy)
                             : kernels::make_cpu_caster(layout.scene, sizes, pages, policy);
}

}  // namespace

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
      page_pool_size_(page_pool_size(options, scene.header(), shading_)),
      allocator_(layout_.cells.size(), layout_.scene.lods, pool_sizes(layout_, options, page_pool_size_)),
      pooled_pages_(page_pool_size_),
      answers_(layout_, shading_, allocator_, pager_, lookup_, pooled_pages_, policy) {
  layout_.scene.light = options.light;
  layout_.scene.is_lit =
      options.surface == Surface::colour && scene.header().has_normals && depends_on_normal(options.light);
  const kernels::PoolSizes sizes = pool_sizes(layout_, options, page_pool_size_);
  pool_bytes_ = sizes.bytes() + page_pool_size_.bytes();
  caster_ = make_caster(layout_, sizes, page_pool_size_, options, policy);
}

void SceneStream::request_roots() {
  finish_preparing();
  if (requests_roots_ || !allocator_.roots_stay()) return;
  requests_roots_ = true;
  for (std::uint32_t root = 0; root < layout_.cells.size(); ++root)
    pending_roots_.push_back(2 * root + std::uint32_t(RequestKind::brick));
  remove_loaded_roots();
}

std::size_t SceneStream::open_requests(const std::vector<std::uint32_t>& requests) const {
  return std::size_t(std::ranges::count_if(requests, [&](std::uint32_t request) { return answers_.is_open(request); }));
}

void SceneStream::remove_loaded_roots() {
  std::erase_if(pending_roots_, [&](std::uint32_t request) { return answers_.is_fulfilled(request); });
}

void SceneStream::begin_pass() {
  finish_preparing();
  pager_.begin_pass();
}

void SceneStream::prepare(const std::vector<std::uint32_t>& requested, const Vec3d& eye) {
  finish_preparing();
  if (!prepared_.empty() || (requested.empty() && pending_roots_.empty())) return;
  stops_preparing_ = false;
  prepared_round_ = allocator_.round();
  const std::uint32_t next_pass = caster_->pass() + 1;
  allocator_.begin_round(next_pass, next_pass, false);
  preparing_ = std::async(std::launch::async, [this, requested, eye] { answer_ahead(requested, eye); });
}

/// Answers requests until prepare() has to end, and enters answers until one needs an eviction. Keeps the other answers
/// of that batch for serve().
void SceneStream::answer_ahead(const std::vector<std::uint32_t>& requested, const Vec3d& eye) {
  pager_.begin_pass();
  answers_.begin_pass(requested, pending_roots_, eye, &stops_preparing_);
  NewData data;
  std::future<std::uint64_t> copy;  // of `data`, while the next requests are answered
  const auto end_copy = [&] {
    if (!copy.valid()) return;
    put_bytes_ += copy.get();
    answers_.reuse(std::move(data.bricks));
  };
  while (answers_.has_next() && prepared_.empty()) {
    const std::span<RequestAnswer> batch = answers_.next_batch(!stops_preparing_);
    std::ranges::move(batch.subspan(enter_without_evictions(batch)), std::back_inserter(prepared_));
    end_copy();
    data = take_new_data();
    copy = std::async(std::launch::async, [&] { return put(data); });
    if (stops_preparing_ && !answers_.has_begun_next()) break;
  }
  answers_.end_pass();
  end_copy();
  if (prepared_.empty()) pooled_pages_.release();
  request_missing_pages();
}

/// Waits until prepare() has ended, and copies its new nodes to the caster.
void SceneStream::finish_preparing() {
  if (!preparing_.valid()) return;
  stops_preparing_ = true;
  preparing_.get();
  put_changed_nodes();
}

void SceneStream::forget_prepared() {
  prepared_.clear();
  pooled_pages_.release();
  entered_ = 0;
}

/// Requests the pages that answers lack. Returns whether there are any.
bool SceneStream::request_missing_pages() {
  std::vector<PageKey> missing = answers_.missing_pages();
  const bool is_any = !missing.empty();
  missing.insert(missing.end(), exchange_missing_.begin(), exchange_missing_.end());
  pager_.request(missing);
  return is_any;
}

/// Enters the answer into the pools; returns false if the pool is full.
bool SceneStream::enter(RequestAnswer& answer) {
  const auto [node, kind] = NodeRequest(answer.request);
  if (answer.is_damaged) {
    allocator_.set_lost(node, kind);
  } else if (kind == RequestKind::children) {
    if (!allocator_.put_children(node, answer.children, *caster_)) return false;
  } else if (answer.is_empty) {
    allocator_.set_empty(node);
  } else {
    const std::optional<std::uint32_t> slot = allocator_.put_brick(node, answer.brick->part_count, *caster_);
    if (!slot) return false;
    new_slots_.push_back(*slot);
    new_bricks_.push_back(std::move(answer.brick));
  }
  return true;
}

/// Enters answers until one needs an eviction. Returns how many it took.
std::size_t SceneStream::enter_without_evictions(std::span<RequestAnswer> answers) {
  std::size_t taken = 0;
  for (RequestAnswer& answer : answers) {
    if (!answer.is_missing && !answers_.is_fulfilled(answer.request)) {
      if (!allocator_.has_room(answer.brick->part_count)) break;
      enter(answer);
      ++prepared_work_.uploads;
    }
    ++taken;
  }
  prepared_work_.answers += taken;
  return taken;
}

/// Enters answers until the pools are full or `enough` returns true, at least some of them. Copies the new bricks to
/// the caster. Returns how many answers it took. Skips answers whose node has got another place since round `round`,
/// before which no answer was made.
std::size_t SceneStream::enter_some(std::span<RequestAnswer> answers, std::uint32_t round,
                                    const kernels::StopAsked& enough, Served& served) {
  std::size_t taken = 0;
  for (RequestAnswer& answer : answers) {
    if (taken > 0 && taken % answers_per_check == 0 && enough && enough()) break;
    ++taken;
    if (answer.is_missing || !allocator_.is_settled(NodeRequest(answer.request).node, round)) continue;
    if (answers_.is_fulfilled(answer.request)) continue;
    served.is_full = !enter(answer);
    if (served.is_full) break;
    ++served.uploads;
  }
  served.answers += taken;
  put_new_bricks();
  return taken;
}

/// Returns the pages and bricks that were added since the last call.
SceneStream::NewData SceneStream::take_new_data() {
  NewData data{pooled_pages_.take_new_pages(), {}, std::exchange(new_bricks_, {})};
  for (const std::uint32_t slot : new_slots_) data.places.push_back(allocator_.brick_place(slot));
  new_slots_.clear();
  return data;
}

/// Copies new data to the caster. Returns the number of copied bytes.
std::uint64_t SceneStream::put(const NewData& data) {
  caster_->put_pages(data.pages);
  caster_->put_bricks(data.places, data.bricks);
  std::uint64_t bytes = 0;
  for (const kernels::PageUpload& page : data.pages) bytes += page_pool_size_.bytes_per_voxel() * page.count;
  for (const auto& brick : data.bricks)
    bytes += sizeof(brick->head) + sizeof(kernels::PackedVoxel) * brick->parts.size() +
             sizeof(kernels::VoxelRun) * brick->runs.size();
  return bytes;
}

void SceneStream::put_new_bricks() {
  NewData data = take_new_data();
  put_bytes_ += put(data);
  answers_.reuse(std::move(data.bricks));
  if (prepared_.empty()) pooled_pages_.release();
}

void SceneStream::put_changed_nodes() {
  const auto changes = allocator_.take_changes();
  put_bytes_ += sizeof(kernels::NodeChange) * changes.size();
  caster_->put_nodes(changes);
}

/// Enters the answers that prepare() could not enter, until `enough` returns true.
void SceneStream::enter_prepared(const kernels::StopAsked& enough, Served& served) {
  if (prepared_.empty()) return;
  entered_ += enter_some(std::span(prepared_).subspan(entered_), prepared_round_, enough, served);
  if (entered_ == prepared_.size() || served.is_full) forget_prepared();
}

SceneStream::Served SceneStream::serve(const std::vector<std::uint32_t>& requested, const Vec3d& eye,
                                       const kernels::StopAsked& enough, const Keep& keep) {
  finish_preparing();
  Served served = std::exchange(prepared_work_, {});
  const bool was_prepared = served.uploads > 0;
  const std::uint32_t round_before = allocator_.round();
  allocator_.begin_round(caster_->pass(), keep.used_since, !keep.all);
  enter_prepared(enough, served);
  const auto is_over = [&] { return served.answers > 0 && enough && enough(); };
  if (!was_prepared && prepared_.empty() && !is_over()) {
    answers_.begin_pass(requested, pending_roots_, eye);
    while (answers_.has_next() && !served.is_full) {
      enter_some(answers_.next_batch(!enough), round_before, {}, served);
      if (is_over()) break;
    }
    answers_.end_pass();
  }
  put_changed_nodes();
  pool_bytes_held_ = allocator_.in_use().bytes() + pooled_pages_.bytes_used();
  served.misses_pages = request_missing_pages();
  remove_loaded_roots();
  served.evicted_used = allocator_.evicted_used();
  uploads_ += served.uploads;
  uploaded_bytes_ += std::exchange(put_bytes_, 0);
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
  finish_preparing();
  Options options;
  options.cells_alone = cells_alone_;
  exchange_missing_.clear();
  exchange_.emplace(open(next, options, policy_, &numbers).map, std::move(changed), allocator_, layout_);
}

bool SceneStream::advance_exchange(const kernels::StopAsked& enough) {
  begin_pass();
  exchange_missing_.clear();
  if (!exchange_->prepare(pager_, shading_, policy_, enough, exchange_missing_)) {
    pager_.request(exchange_missing_);
    return false;
  }
  uploads_ += exchange_->enter(*caster_);
  map_ = exchange_->take_map();
  answers_.forget_pages();  // they belong to the previous map
  forget_prepared();
  exchange_.reset();
  return true;
}

}  // namespace gigabake
