#include <algorithm>
#include <cub/device/device_scan.cuh>
#include <cub/device/device_select.cuh>
#include <limits>
#include <thrust/iterator/counting_iterator.h>

#include "kernels/cuda_fill.cuh"
#include "kernels/cuda_voxelize.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, item_blocks = 4096, hard_blocks = 512;

__device__ std::uint32_t pairs_of(const FillView& view, std::uint32_t first, std::uint32_t end) {
  return view.bricks.start[end] - view.bricks.start[first];
}

/// Bricks of the groups with many triangles, one by one: heavy ones, and those that need wide sums.
__global__ void find_heavy_bricks(FillView view) {
  const std::uint32_t first = view.begin + (blockIdx.x * blockDim.x + threadIdx.x) * bricks_per_block;
  if (first >= view.end || !items_fit(view)) return;
  const std::uint32_t end = smaller(first + bricks_per_block, view.end);
  if (pairs_of(view, first, end) <= most_pairs_together) return;
  for (std::uint32_t b = first; b < end; ++b) {
    if (pairs_of(view, b, b + 1) <= std::uint32_t(fragments_before_flush))
      view.heavy[atomicAdd(&view.counters->heavy, 1u)] = BrickSpan(b, 1).word();
    else
      view.hard[atomicAdd(&view.counters->hard, 1u)] = BrickSpan(b, 1).word();
  }
}

/// Heavy bricks, a block each, then groups of the others.
template <bool plain>
__global__ void __launch_bounds__(fill_threads, FillWidth<false, plain>::blocks) fill_easy_bricks(FillView view) {
  extern __shared__ __align__(16) unsigned char raw[];
  auto& shared = *reinterpret_cast<FillShared<false, plain>*>(raw);
  if (!items_fit(view)) return;
  BrickSpan span(0, 0);
  if (blockIdx.x < view.heavy_capacity) {
    if (blockIdx.x >= view.counters->heavy) return;
    span = BrickSpan(view.heavy[blockIdx.x]);
  } else {
    span.first = view.begin + (blockIdx.x - view.heavy_capacity) * bricks_per_block;
    span.bricks = smaller<std::uint32_t>(bricks_per_block, view.end - span.first);
    if (pairs_of(view, span.first, span.first + span.bricks) > most_pairs_together) return;
  }
  if (!fill_bricks(view, span, shared) && threadIdx.x == 0)
    view.hard[atomicAdd(&view.counters->hard, 1u)] = span.word();
}

template <bool plain>
__global__ void __launch_bounds__(fill_threads) fill_hard_bricks(FillView view) {
  extern __shared__ __align__(16) unsigned char raw[];
  auto& shared = *reinterpret_cast<FillShared<true, plain>*>(raw);
  for (std::uint32_t i = blockIdx.x; items_fit(view) && i < view.counters->hard; i += gridDim.x) {
    __syncthreads();
    fill_bricks(view, BrickSpan(view.hard[i]), shared);
  }
}

/// A batch's voxels from the stage to their place in the level, without the empty places. One warp a brick.
__global__ void unstage(FillView view, const std::uint32_t* first, std::uint32_t* rgba, std::uint16_t* normal,
                        std::uint32_t capacity) {
  if (blockIdx.x == 0 && threadIdx.x == 0) {
    FillView::Counters& c = *view.counters;
    c.most_items = larger(c.most_items, c.items);
    c.most_staged = larger(c.most_staged, c.staged);
    c.all_staged += c.staged;
    c.most_pairs = larger(c.most_pairs, view.bricks.start[view.end] - view.bricks.start[view.begin]);
  }
  const std::uint32_t brick = view.begin + (blockIdx.x * blockDim.x + threadIdx.x) / 32, lane = threadIdx.x & 31;
  if (brick >= view.end || !items_fit(view)) return;
  const std::uint32_t staged = view.staged[brick], from = view.staged_at[brick];
  std::uint32_t to = first[brick];
  if (std::uint64_t(from) + staged > view.stage_capacity || std::uint64_t(to) + view.count[brick] > capacity) return;
  for (std::uint32_t step = 0; step < staged; step += 32) {
    const std::uint32_t i = step + lane, voxel = i < staged ? view.stage_rgba[from + i] : 0;
    const unsigned who = __ballot_sync(~0u, voxel != 0);
    const std::uint32_t at = to + std::uint32_t(__popc(who & ((1u << lane) - 1)));
    if (voxel != 0) {
      rgba[at] = voxel;
      if (normal != nullptr) normal[at] = view.stage_normal[from + i];
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

template <bool plain>
void launch_fill(const FillView& view, SurfaceRule rule, cudaStream_t stream) {
  constexpr std::size_t bytes = sizeof(FillShared<false, plain>), hard_bytes = sizeof(FillShared<true, plain>);
  allow_shared(fill_easy_bricks<plain>, bytes);
  allow_shared(fill_hard_bricks<plain>, hard_bytes);
  find_items<<<item_blocks, pairs_per_group, 0, stream>>>(view.input, rule, view.bricks, view.begin, view.end,
                                                          view.items);
  check_launch("find_items");
  const unsigned groups = grid_of(view.end - view.begin, bricks_per_block);
  find_heavy_bricks<<<grid_of(groups, threads), threads, 0, stream>>>(view);
  check_launch("find_heavy_bricks");
  fill_easy_bricks<plain><<<view.heavy_capacity + groups, fill_threads, bytes, stream>>>(view);
  check_launch("fill_easy_bricks");
  fill_hard_bricks<plain><<<hard_blocks, fill_threads, hard_bytes, stream>>>(view);
  check_launch("fill_hard_bricks");
}

/// Everything of one try: bricks as they were listed, empty ones among them.
struct Filled {
  DeviceArray<std::uint64_t> mask;
  DeviceArray<std::uint32_t> count, first, rgba;
  DeviceArray<std::uint16_t> normal;
  FillView::Counters counted{};
  std::uint32_t voxels = 0;
};

/// Sizes of one try.
struct FillSizes {
  std::uint32_t voxels, bricks_per_batch, pairs_per_batch, items_per_batch, stage_voxels;
};

/// Bricks, batch by batch, through items and a stage of limited size.
class Filler {
 public:
  Filler(DeviceHeap& heap, const InputView& input, SurfaceRule rule, const BrickLists& lists, bool normals, bool plain,
         const FillSizes& sizes)
      : heap_(heap),
        rule_(rule),
        plain_(plain),
        sizes_(sizes),
        stage_rgba_(heap, sizes.stage_voxels),
        staged_(heap, lists.bricks),
        staged_at_(heap, lists.bricks),
        heavy_(heap, bricks_per_block * (sizes.pairs_per_batch / most_pairs_together + 1)),
        hard_(heap, sizes.bricks_per_batch),
        where_(heap, sizes.items_per_batch),
        first_(heap, sizes.pairs_per_batch),
        group_end_(heap, sizes.pairs_per_batch / pairs_per_group + 1),
        cells_(heap, sizes.items_per_batch),
        stage_normal_(heap, normals ? sizes.stage_voxels : 0),
        counters_(heap, 1) {
    const std::uint32_t n = lists.bricks;
    out_.mask = DeviceArray<std::uint64_t>(heap_, 8 * std::size_t(n));
    out_.count = DeviceArray<std::uint32_t>(heap_, n + 1);
    out_.first = DeviceArray<std::uint32_t>(heap_, n + 1);
    out_.rgba = DeviceArray<std::uint32_t>(heap_, sizes.voxels);
    if (normals) out_.normal = DeviceArray<std::uint16_t>(heap_, sizes.voxels);
    counters_.clear_to_zero();
    out_.count.clear_to_zero();
    out_.first.clear_to_zero();
    view_.input = input;
    view_.bricks = {lists.key.data(), lists.start.data(), lists.triangle.data()};
    view_.items = {cells_.data(),         where_.data(),         first_.data(),           group_end_.data(),
                   sizes.items_per_batch, sizes.pairs_per_batch, &counters_.data()->items};
    view_.mask = out_.mask.data();
    view_.count = out_.count.data();
    view_.staged = staged_.data();
    view_.staged_at = staged_at_.data();
    view_.stage_rgba = stage_rgba_.data();
    view_.stage_normal = normals ? stage_normal_.data() : nullptr;
    view_.stage_capacity = sizes.stage_voxels;
    view_.counters = counters_.data();
    view_.heavy = heavy_.data();
    view_.heavy_capacity = std::uint32_t(heavy_.size());
    view_.hard = hard_.data();
    scan(nullptr, temporary_bytes_, 0, std::min(n, sizes.bricks_per_batch));
    temporary_ = TemporaryStorage(heap, temporary_bytes_);
  }

  Filled fill(std::uint32_t bricks) {
    for (view_.begin = 0; view_.begin < bricks; view_.begin = view_.end) {
      view_.end = std::min(bricks, view_.begin + sizes_.bricks_per_batch);
      fill_batch();
    }
    check_cuda(
        cudaMemcpyAsync(&out_.counted, counters_.data(), sizeof out_.counted, cudaMemcpyDeviceToHost, heap_.stream()),
        "cudaMemcpyAsync (fill counters)");
    check_cuda(cudaMemcpyAsync(&out_.voxels, out_.first.data() + bricks, sizeof out_.voxels, cudaMemcpyDeviceToHost,
                               heap_.stream()),
               "cudaMemcpyAsync (voxel count)");
    check_cuda(cudaStreamSynchronize(heap_.stream()), "cudaStreamSynchronize (voxelize)");
    return std::move(out_);
  }

 private:
  void fill_batch() {
    const cudaStream_t stream = heap_.stream();
    check_cuda(cudaMemsetAsync(view_.counters, 0, offsetof(FillView::Counters, most_items), stream), "cudaMemsetAsync");
    plain_ ? launch_fill<true>(view_, rule_, stream) : launch_fill<false>(view_, rule_, stream);
    std::size_t bytes = temporary_bytes_;
    scan(temporary_.data(), bytes, view_.begin, view_.end);
    unstage<<<grid_of(32 * std::uint64_t(view_.end - view_.begin), threads), threads, 0, stream>>>(
        view_, out_.first.data(), out_.rgba.data(), out_.normal.data(), sizes_.voxels);
    check_launch("unstage");
  }

  /// first[begin] is there; the batch's other ones, and the next batch's first, follow.
  void scan(void* temporary, std::size_t& bytes, std::uint32_t begin, std::uint32_t end) {
    check_cuda(cub::DeviceScan::ExclusiveScan(
                   temporary, bytes, out_.count.data() + begin, out_.first.data() + begin, ::cuda::std::plus<>{},
                   cub::FutureValue<std::uint32_t>(out_.first.data() + begin), int(end - begin + 1), heap_.stream()),
               "DeviceScan");
  }

  DeviceHeap& heap_;
  SurfaceRule rule_;
  bool plain_;
  FillSizes sizes_;
  DeviceArray<std::uint32_t> stage_rgba_, staged_, staged_at_, heavy_, hard_, where_, first_, group_end_;
  DeviceArray<std::uint64_t> cells_;
  DeviceArray<std::uint16_t> stage_normal_;
  DeviceArray<FillView::Counters> counters_;
  Filled out_;
  FillView view_{};
  std::size_t temporary_bytes_ = 0;
  TemporaryStorage temporary_;
};

/// Without the bricks that nothing visible is in.
DeviceLevel without_empty(DeviceHeap& heap, const BrickLists& lists, Filled filled) {
  DeviceLevel level;
  DeviceArray<std::uint32_t> kept(heap, lists.bricks), kept_count(heap, 1);
  const thrust::counting_iterator<std::uint32_t> counting(0);
  const HasVoxels has_voxels{filled.count.data()};
  std::size_t bytes = 0;
  check_cuda(cub::DeviceSelect::If(nullptr, bytes, counting, kept.data(), kept_count.data(), lists.bricks, has_voxels,
                                   heap.stream()),
             "DeviceSelect");
  TemporaryStorage temporary(heap, bytes);
  check_cuda(cub::DeviceSelect::If(temporary.data(), bytes, counting, kept.data(), kept_count.data(), lists.bricks,
                                   has_voxels, heap.stream()),
             "DeviceSelect");
  check_cuda(
      cudaMemcpyAsync(&level.bricks, kept_count.data(), sizeof level.bricks, cudaMemcpyDeviceToHost, heap.stream()),
      "cudaMemcpyAsync (kept bricks)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (kept bricks)");
  level.voxels = filled.voxels;
  level.key = DeviceArray<std::uint32_t>(heap, level.bricks);
  level.first = DeviceArray<std::uint32_t>(heap, level.bricks + 1);
  level.mask = DeviceArray<std::uint64_t>(heap, 8 * std::size_t(level.bricks));
  keep_bricks<<<grid_of(8 * std::uint64_t(level.bricks), threads), threads, 0, heap.stream()>>>(
      kept.data(), level.bricks, lists.key.data(), filled.first.data(), filled.mask.data(), level.voxels,
      level.key.data(), level.first.data(), level.mask.data());
  check_launch("keep_bricks");
  level.rgba = std::move(filled.rgba);
  level.normal = std::move(filled.normal);
  return level;
}

/// Batches of about this many pairs, or voxels: small beside a cell's input and output, and a launch costs little
/// beside them.
constexpr std::uint64_t pairs_per_batch = std::uint64_t(1) << 19, voxels_per_batch = std::uint64_t(3) << 19;

std::uint32_t counted_32(std::uint64_t n) {
  if (n > std::numeric_limits<std::uint32_t>::max()) throw DeviceFull("more than 2^32-1 voxels");
  return std::uint32_t(n);
}

std::uint32_t with_room(double wanted, std::uint64_t least) {
  return counted_32(std::max(std::uint64_t(1.125 * wanted), least));
}

FillSizes first_sizes(const BrickLists& lists, const FillRatios& ratios) {
  const std::uint64_t pairs = lists.triangle.size(),
                      batch = std::min({pairs, pairs_per_batch,
                                        1 + std::uint64_t(double(voxels_per_batch) / ratios.voxels_per_pair)});
  FillSizes s;
  s.bricks_per_batch = std::uint32_t(std::max<std::uint64_t>(1, lists.bricks * batch / pairs));
  s.pairs_per_batch = with_room(double(batch) * ratios.pairs_spread, pairs_per_group);
  s.items_per_batch = with_room(double(batch) * ratios.pairs_spread * ratios.items_per_pair, 1024);
  s.voxels = with_room(double(pairs) * ratios.voxels_per_pair, 1024);
  s.stage_voxels = std::min(s.voxels, with_room(double(batch) * ratios.voxels_per_pair * ratios.voxels_spread, 1024));
  return s;
}

/// False: it did not fit; sizes are what the next try needs.
bool fits(const Filled& filled, FillSizes& s) {
  const FillView::Counters& counted = filled.counted;
  const FillSizes tried = s;
  counted_32(counted.all_staged);
  s.pairs_per_batch = std::max(s.pairs_per_batch, counted.most_pairs);
  s.items_per_batch = std::max(s.items_per_batch, counted.most_items);
  s.voxels = std::max(s.voxels, filled.voxels);
  s.stage_voxels = std::max(s.stage_voxels, counted.most_staged);
  return s.pairs_per_batch == tried.pairs_per_batch && s.items_per_batch == tried.items_per_batch &&
         s.voxels == tried.voxels && s.stage_voxels == tried.stage_voxels;
}

void learn(const Filled& filled, const BrickLists& lists, const FillSizes& sizes, FillRatios& ratios) {
  const FillView::Counters& counted = filled.counted;
  const double pairs = double(lists.triangle.size());
  const double mean_batch = pairs * std::min(1.0, double(sizes.bricks_per_batch) / double(lists.bricks));
  ratios.voxels_per_pair = std::max(0.01, double(filled.voxels) / pairs);
  ratios.items_per_pair = std::max(0.01, double(counted.most_items) / std::max(1.0, double(counted.most_pairs)));
  ratios.pairs_spread = std::max(1.0, double(counted.most_pairs) / mean_batch);
  ratios.voxels_spread = std::max(1.0, double(counted.most_staged) / (mean_batch * ratios.voxels_per_pair));
}

}  // namespace

DeviceLevel voxelize(DeviceHeap& heap, const InputView& input, const WindowView& window, BrickLists lists, bool normals,
                     bool plain, FillRatios& ratios, CellStats& stats) {
  FillSizes sizes = first_sizes(lists, ratios);
  for (;;) {
    Filled filled = Filler(heap, input, window.rule, lists, normals, plain, sizes).fill(lists.bricks);
    if (!fits(filled, sizes)) continue;
    stats.fragments += filled.counted.fragments;
    learn(filled, lists, sizes, ratios);
    return without_empty(heap, lists, std::move(filled));
  }
}

}  // namespace gigabake::kernels
