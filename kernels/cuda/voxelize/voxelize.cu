#include <algorithm>
#include <cub/device/device_scan.cuh>
#include <limits>

#include "core/base/rules.h"
#include "kernels/cuda/voxelize/select.cuh"
#include "kernels/cuda/voxelize/voxelize.cuh"
#include "kernels/cuda/voxelize/waves.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, item_blocks = 4096, heavy_blocks = 512, hard_blocks = 512;

/// Fills heavy bricks, one brick at a time per block, and groups of easy bricks, one group per block.
template <CellMaterials materials>
__global__ void __launch_bounds__(fill_threads, FillWidth<false, materials>::blocks) fill_easy_bricks(BatchView view) {
  extern __shared__ __align__(16) unsigned char raw[];
  auto& shared = *reinterpret_cast<FillShared<false, materials>*>(raw);
  if (!items_fit(view)) return;
  // Calls fill_bricks() once for both cases: a second inlined copy would exceed the instruction cache.
  const bool is_heavy = blockIdx.x < heavy_blocks;
  const std::uint32_t group = blockIdx.x - heavy_blocks,
                      end = is_heavy ? view.counters->heavy : blockIdx.x + view.is_easy[group];
  for (std::uint32_t i = blockIdx.x; i < end; i += heavy_blocks) {
    BrickSpan span(view.begin + group * bricks_per_block, 0);
    if (is_heavy)
      span = BrickSpan(view.heavy[i]);
    else
      span.bricks = smaller<std::uint32_t>(bricks_per_block, view.end - span.first);
    fill_bricks(view, span, shared);
    __syncthreads();
  }
}

template <CellMaterials materials>
__global__ void __launch_bounds__(fill_threads) fill_hard_bricks(BatchView view) {
  extern __shared__ __align__(16) unsigned char raw[];
  auto& shared = *reinterpret_cast<FillShared<true, materials>*>(raw);
  for (std::uint32_t i = blockIdx.x; items_fit(view) && i < view.counters->hard; i += gridDim.x) {
    __syncthreads();
    fill_bricks(view, BrickSpan(view.hard[i]), shared);
  }
}

/// Moves a batch's voxels from the staging arrays to their places in the level and removes the empty places. One warp
/// per brick.
__global__ void unstage(BatchView view, const std::uint32_t* first, std::uint32_t* rgba, std::uint16_t* normal,
                        std::uint32_t* plane, std::uint32_t capacity) {
  if (blockIdx.x == 0 && threadIdx.x == 0 && items_fit(view))
    view.counters->max_staged = larger(view.counters->max_staged, view.place[view.end - 1] + view.marked[view.end - 1]);
  const std::uint32_t brick = view.begin + (blockIdx.x * blockDim.x + threadIdx.x) / 32, lane = threadIdx.x & 31;
  if (brick >= view.end || !items_fit(view)) return;
  const std::uint32_t staged = view.marked[brick], from = view.place[brick];
  std::uint32_t to = first[brick];
  if (std::uint64_t(from) + staged > view.capacity || std::uint64_t(to) + view.visible[brick] > capacity) return;
  for (std::uint32_t step = 0; step < staged; step += 32) {
    const std::uint32_t i = step + lane, voxel = i < staged ? view.rgba[from + i] : 0;
    const unsigned who = __ballot_sync(~0u, voxel != 0);
    const std::uint32_t at = to + std::uint32_t(__popc(who & ((1u << lane) - 1)));
    if (voxel != 0) {
      rgba[at] = voxel;
      if (normal != nullptr) normal[at] = view.normal[from + i];
      if (plane != nullptr) plane[at] = view.plane[from + i];
    }
    to += std::uint32_t(__popc(who));
  }
}

struct HasVoxels {
  const std::uint32_t* count;
  __device__ bool operator()(std::uint32_t brick) const { return count[brick] != 0; }
};

__global__ void keep_bricks(const std::uint32_t* kept, std::uint32_t bricks, const std::uint32_t* key,
                            const std::uint32_t* first, const std::uint64_t* mask, std::uint32_t voxels,
                            std::uint32_t* key_out, std::uint32_t* first_out, std::uint64_t* mask_out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  const std::uint32_t b = i / 8;
  if (i == 0) first_out[bricks] = voxels;
  if (b >= bricks) return;
  const std::uint32_t from = kept[b];
  mask_out[i] = mask[8 * std::size_t(from) + i % 8];
  if (i % 8 != 0) return;
  key_out[b] = key[from];
  first_out[b] = first[from];
}

template <class Kernel>
void allow_shared(Kernel kernel, std::size_t bytes) {
  check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(bytes)),
             "cudaFuncSetAttribute");
}

template <CellMaterials materials>
void launch_fill(const BatchView& view, cudaStream_t stream) {
  constexpr std::size_t bytes = sizeof(FillShared<false, materials>), hard_bytes = sizeof(FillShared<true, materials>);
  allow_shared(fill_easy_bricks<materials>, bytes);
  allow_shared(fill_hard_bricks<materials>, hard_bytes);
  const unsigned groups = grid_of(view.end - view.begin, bricks_per_block);
  fill_easy_bricks<materials><<<heavy_blocks + groups, fill_threads, bytes, stream>>>(view);
  check_launch("fill_easy_bricks");
  fill_hard_bricks<materials><<<hard_blocks, fill_threads, hard_bytes, stream>>>(view);
  check_launch("fill_hard_bricks");
}

/// Result of one attempt: all listed bricks, including empty bricks.
struct Filled {
  DeviceArray<std::uint64_t> mask;
  DeviceArray<std::uint32_t> count, first, rgba;
  DeviceArray<std::uint16_t> normal;
  DeviceArray<std::uint8_t> directional_coverage;  ///< empty if lod-0 voxels have no planes
  BatchCounters counted{};

  std::uint32_t* plane() { return reinterpret_cast<std::uint32_t*>(directional_coverage.data()); }
};

/// Array sizes of one attempt to fill the bricks; if they do not suffice, the next attempt has larger arrays.
/// `stage_voxels` is 0 if all marked voxels are visible.
struct FillSizes {
  std::uint32_t voxels, bricks_per_batch, pairs_per_batch, items_per_batch, stage_voxels;
};

/// The channels of a lod-0 voxel in addition to its colour.
struct FinestChannels {
  bool normals, planes;

  /// Returns the bytes of a voxel.
  std::size_t bytes() const {
    return sizeof(std::uint32_t) + (normals ? sizeof(std::uint16_t) : 0) + (planes ? directional_coverage_bytes : 0);
  }
};

/// Filler of bricks, batch by batch, with item arrays of limited size. If voxels may be invisible, a batch is first
/// written to staging arrays.
class Filler {
 public:
  Filler(DeviceHeap& heap, const InputView& input, SurfaceRule rule, const BrickLists& lists, FinestChannels channels,
         CellMaterials materials, const FillSizes& sizes)
      : heap_(heap),
        rule_(rule),
        materials_(materials),
        sizes_(sizes),
        stage_rgba_(heap, sizes.stage_voxels),
        marked_(heap, all_visible(materials) ? 0 : lists.bricks),
        place_(heap, all_visible(materials) ? 0 : lists.bricks),
        items_of_(heap, sizes.bricks_per_batch),
        heavy_(heap, bricks_per_block * (sizes.pairs_per_batch / max_pairs_together + 1)),
        hard_(heap, sizes.bricks_per_batch),
        where_(heap, sizes.items_per_batch),
        first_(heap, sizes.pairs_per_batch),
        group_end_(heap, sizes.pairs_per_batch / pairs_per_group + 1),
        cells_(heap, sizes.items_per_batch),
        stage_normal_(heap, channels.normals ? sizes.stage_voxels : 0),
        stage_plane_(heap, channels.planes ? sizes.stage_voxels : 0),
        is_easy_(heap, sizes.bricks_per_batch / bricks_per_block + 1),
        counters_(heap, 1) {
    const std::uint32_t n = lists.bricks;
    out_.mask = DeviceArray<std::uint64_t>(heap_, 8 * std::size_t(n));
    out_.count = DeviceArray<std::uint32_t>(heap_, n + 1);
    out_.first = DeviceArray<std::uint32_t>(heap_, n + 1);
    out_.rgba = DeviceArray<std::uint32_t>(heap_, sizes.voxels);
    if (channels.normals) out_.normal = DeviceArray<std::uint16_t>(heap_, sizes.voxels);
    if (channels.planes)
      out_.directional_coverage =
          DeviceArray<std::uint8_t>(heap_, directional_coverage_bytes * std::size_t(sizes.voxels));
    counters_.clear_to_zero();
    if (!all_visible(materials)) marked_.clear_to_zero();  // batches that do not fit leave it unchanged
    out_.count.clear_to_zero();
    out_.first.clear_to_zero();
    view_.input = input;
    view_.bricks = {lists.key.data(), lists.start.data(), lists.triangle.data()};
    view_.items = {cells_.data(),         where_.data(),         first_.data(),           group_end_.data(),
                   sizes.items_per_batch, sizes.pairs_per_batch, &counters_.data()->items};
    view_.mask = out_.mask.data();
    view_.visible = out_.count.data();
    const bool at_once = all_visible(materials);
    view_.marked = at_once ? out_.count.data() : marked_.data();
    view_.place = at_once ? out_.first.data() : place_.data();
    view_.items_of = items_of_.data();
    view_.is_easy = is_easy_.data();
    view_.rgba = at_once ? out_.rgba.data() : stage_rgba_.data();
    if (channels.normals) view_.normal = at_once ? out_.normal.data() : stage_normal_.data();
    if (channels.planes) view_.plane = at_once ? out_.plane() : stage_plane_.data();
    view_.capacity = at_once ? sizes.voxels : sizes.stage_voxels;
    view_.counters = counters_.data();
    view_.heavy = heavy_.data();
    view_.hard = hard_.data();
    sum_visible(nullptr, temporary_bytes_, 0, std::min(n, sizes.bricks_per_batch));
    std::size_t more = 0;
    place(nullptr, more, 0, std::min(n, sizes.bricks_per_batch));
    temporary_bytes_ = std::max(temporary_bytes_, more);
    temporary_ = TemporaryStorage(heap, temporary_bytes_);
  }

  Filled fill(std::uint32_t bricks) {
    for (view_.begin = 0; view_.begin < bricks; view_.begin = view_.end) {
      view_.end = std::min(bricks, view_.begin + sizes_.bricks_per_batch);
      fill_batch();
    }
    check_cuda(cudaMemcpyAsync(&view_.counters->visible, out_.first.data() + bricks, sizeof view_.counters->visible,
                               cudaMemcpyDeviceToDevice, heap_.stream()),
               "cudaMemcpyAsync (voxel count)");
    heap_.bring(&out_.counted, counters_.data(), sizeof out_.counted, "filling bricks");
    return std::move(out_);
  }

 private:
  void fill_batch() {
    const cudaStream_t stream = heap_.stream();
    check_cuda(cudaMemsetAsync(view_.counters, 0, offsetof(BatchCounters, max_items), stream), "cudaMemsetAsync");
    find_items<<<item_blocks, pairs_per_group, 0, stream>>>(view_.input, rule_, view_.bricks, view_.begin, view_.end,
                                                            view_.items);
    check_launch("find_items");
    mark_bricks<<<grid_of(view_.end - view_.begin, bricks_per_block), 32 * bricks_per_block, 0, stream>>>(view_);
    check_launch("mark_bricks");
    std::size_t bytes = temporary_bytes_;
    if (all_visible(materials_)) {
      sum_visible(temporary_.data(), bytes, view_.begin, view_.end);
      if (materials_ == CellMaterials::plain)
        launch_fill<CellMaterials::plain>(view_, stream);
      else if (materials_ == CellMaterials::smooth_opaque)
        launch_fill<CellMaterials::smooth_opaque>(view_, stream);
      else if (materials_ == CellMaterials::mapped_opaque)
        launch_fill<CellMaterials::mapped_opaque>(view_, stream);
      else
        launch_fill<CellMaterials::opaque>(view_, stream);
      return;
    }
    place(temporary_.data(), bytes, view_.begin, view_.end);
    if (materials_ == CellMaterials::smooth)
      launch_fill<CellMaterials::smooth>(view_, stream);
    else if (materials_ == CellMaterials::mapped)
      launch_fill<CellMaterials::mapped>(view_, stream);
    else
      launch_fill<CellMaterials::any>(view_, stream);
    bytes = temporary_bytes_;
    sum_visible(temporary_.data(), bytes, view_.begin, view_.end);
    unstage<<<grid_of(32 * std::uint64_t(view_.end - view_.begin), threads), threads, 0, stream>>>(
        view_, out_.first.data(), out_.rgba.data(), out_.normal.data(), out_.plane(), sizes_.voxels);
    check_launch("unstage");
  }

  /// Computes first[] of the batch's bricks and of the next batch's first brick. first[begin] must be set.
  void sum_visible(void* temporary, std::size_t& bytes, std::uint32_t begin, std::uint32_t end) {
    check_cuda(cub::DeviceScan::ExclusiveScan(
                   temporary, bytes, out_.count.data() + begin, out_.first.data() + begin, ::cuda::std::plus<>{},
                   cub::FutureValue<std::uint32_t>(out_.first.data() + begin), int(end - begin + 1), heap_.stream()),
               "DeviceScan");
  }

  /// Computes the batch's places in the staging arrays.
  void place(void* temporary, std::size_t& bytes, std::uint32_t begin, std::uint32_t end) {
    check_cuda(cub::DeviceScan::ExclusiveSum(temporary, bytes, marked_.data() + begin, place_.data() + begin,
                                             int(end - begin), heap_.stream()),
               "DeviceScan");
  }

  DeviceHeap& heap_;
  SurfaceRule rule_;
  CellMaterials materials_;
  FillSizes sizes_;
  DeviceArray<std::uint32_t> stage_rgba_, marked_, place_, items_of_, heavy_, hard_, where_, first_, group_end_;
  DeviceArray<std::uint64_t> cells_;
  DeviceArray<std::uint16_t> stage_normal_;
  DeviceArray<std::uint32_t> stage_plane_;
  DeviceArray<std::uint8_t> is_easy_;
  DeviceArray<BatchCounters> counters_;
  Filled out_;
  BatchView view_{};
  std::size_t temporary_bytes_ = 0;
  TemporaryStorage temporary_;
};

/// Removes the bricks without a visible voxel.
DeviceLevel without_empty(DeviceHeap& heap, const BrickLists& lists, Filled filled) {
  DeviceLevel level;
  const DeviceArray<std::uint32_t> kept(heap, lists.bricks);
  level.bricks = select_indices(heap, lists.bricks, HasVoxels{filled.count.data()}, kept.data());
  level.voxels = filled.counted.visible;
  level.key = DeviceArray<std::uint32_t>(heap, level.bricks);
  level.first = DeviceArray<std::uint32_t>(heap, level.bricks + 1);
  level.mask = DeviceArray<std::uint64_t>(heap, 8 * std::size_t(level.bricks));
  keep_bricks<<<grid_of(8 * std::uint64_t(level.bricks), threads), threads, 0, heap.stream()>>>(
      kept.data(), level.bricks, lists.key.data(), filled.first.data(), filled.mask.data(), level.voxels,
      level.key.data(), level.first.data(), level.mask.data());
  check_launch("keep_bricks");
  level.rgba = std::move(filled.rgba);
  level.normal = std::move(filled.normal);
  level.directional_coverage = std::move(filled.directional_coverage);
  return level;
}

/// Sizes of a batch. A batch's arrays are small compared with a cell's input and output. Its run time is long compared
/// with that of a launch.
constexpr std::uint64_t min_pairs_per_batch = std::uint64_t(1) << 16, pairs_per_batch = std::uint64_t(1) << 20,
                        voxels_per_batch = std::uint64_t(3) << 20;
constexpr double min_bricks_per_batch = 660;
constexpr double spare = 1.125;  ///< factor over the expected sizes, so that retries are rare

std::uint32_t counted_32(std::uint64_t n) {
  if (n > std::numeric_limits<std::uint32_t>::max()) throw DeviceFull("more than 2^32-1 voxels");
  return std::uint32_t(n);
}

std::uint32_t with_capacity(double wanted, std::uint64_t minimum) {
  return counted_32(std::max(std::uint64_t(spare * wanted), minimum));
}

/// Returns the max number of pairs per batch. The batch's items and staging arrays use the memory that the cell's
/// voxels leave.
std::uint64_t pairs_that_fit(const BrickLists& lists, const FillRatios& ratios, bool at_once,
                             std::size_t bytes_of_voxel, double capacity_bytes) {
  const double pairs = double(lists.triangle.size()), voxel_bytes = double(bytes_of_voxel),
               item_bytes = sizeof(std::uint64_t) + sizeof(std::uint32_t), mask_bytes = 64 + 2 * sizeof(std::uint32_t);
  const double kept = mask_bytes * lists.bricks + spare * voxel_bytes * ratios.voxels_per_pair * pairs,
               of_pair = spare * (ratios.pairs_spread * ratios.items_per_pair * item_bytes + sizeof(std::uint32_t) +
                                  (at_once ? 0 : voxel_bytes * ratios.voxels_per_pair * ratios.voxels_spread));
  // A batch has enough bricks to occupy a device, because a brick takes long if its triangles are much smaller than
  // voxels.
  const std::uint64_t minimum =
      std::max(min_pairs_per_batch, std::uint64_t(min_bricks_per_batch * pairs / lists.bricks));
  return std::max(minimum, std::uint64_t(std::max(0.0, capacity_bytes - kept) / of_pair));
}

FillSizes first_sizes(const BrickLists& lists, const FillRatios& ratios, bool at_once, std::size_t bytes_of_voxel,
                      double capacity_bytes) {
  const std::uint64_t pairs = lists.triangle.size(),
                      batch = std::min({pairs, pairs_per_batch,
                                        pairs_that_fit(lists, ratios, at_once, bytes_of_voxel, capacity_bytes),
                                        1 + std::uint64_t(double(voxels_per_batch) / ratios.voxels_per_pair)});
  FillSizes s;
  s.bricks_per_batch = std::uint32_t(std::max<std::uint64_t>(1, lists.bricks * batch / pairs));
  s.pairs_per_batch = with_capacity(double(batch) * ratios.pairs_spread, pairs_per_group);
  s.items_per_batch = with_capacity(double(batch) * ratios.pairs_spread * ratios.items_per_pair, 1024);
  s.voxels = with_capacity(double(pairs) * ratios.voxels_per_pair, 1024);
  s.stage_voxels =
      at_once ? 0
              : std::min(s.voxels, with_capacity(double(batch) * ratios.voxels_per_pair * ratios.voxels_spread, 1024));
  return s;
}

/// Returns true if the attempt's arrays sufficed. If not, sets `s` to the sizes of the next attempt.
bool fits(const Filled& filled, FillSizes& s) {
  const BatchCounters& counted = filled.counted;
  const FillSizes tried = s;
  counted_32(counted.voxels);
  s.pairs_per_batch = std::max(s.pairs_per_batch, counted.max_pairs);
  s.items_per_batch = std::max(s.items_per_batch, counted.max_items);
  s.voxels = std::max(s.voxels, filled.counted.visible);
  s.stage_voxels = std::max(s.stage_voxels, counted.max_staged);
  return s.pairs_per_batch == tried.pairs_per_batch && s.items_per_batch == tried.items_per_batch &&
         s.voxels == tried.voxels && s.stage_voxels == tried.stage_voxels;
}

void learn(const Filled& filled, const BrickLists& lists, const FillSizes& sizes, FillRatios& ratios) {
  const BatchCounters& counted = filled.counted;
  const double pairs = double(lists.triangle.size());
  const double mean_batch = pairs * std::min(1.0, double(sizes.bricks_per_batch) / double(lists.bricks));
  ratios.voxels_per_pair = std::max(0.01, double(filled.counted.visible) / pairs);
  ratios.items_per_pair = std::max(0.01, double(counted.max_items) / std::max(1.0, double(counted.max_pairs)));
  ratios.pairs_spread = std::max(1.0, double(counted.max_pairs) / mean_batch);
  if (sizes.stage_voxels != 0)
    ratios.voxels_spread = std::max(1.0, double(counted.max_staged) / (mean_batch * ratios.voxels_per_pair));
}

}  // namespace

DeviceLevel voxelize(DeviceHeap& heap, const InputView& input, std::uint64_t capacity_bytes, const CellWindow& window,
                     BrickLists lists, const CellParameters& parameters, CellMaterials materials, FillRatios& ratios,
                     CellStats& stats) {
  const FinestChannels channels{parameters.normals, has_finest_planes(parameters)};
  FillSizes sizes = first_sizes(lists, ratios, all_visible(materials), channels.bytes(),
                                double(capacity_bytes) - double(heap.live()));
  for (;;) {
    Filled filled = Filler(heap, input, window.rule, lists, channels, materials, sizes).fill(lists.bricks);
    if (!fits(filled, sizes)) continue;
    stats.fragments += filled.counted.fragments;
    learn(filled, lists, sizes, ratios);
    return without_empty(heap, lists, std::move(filled));
  }
}

}  // namespace gigabake::kernels
