#include <algorithm>
#include <cub/device/device_scan.cuh>
#include <limits>

#include "core/base/rules.h"
#include "core/octree/brick.h"
#include "kernels/cuda/voxelize/fill.cuh"
#include "kernels/cuda/voxelize/filler.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned item_blocks = 4096;

/// The arrays of one batch, which the next batch reuses.
struct BatchArrays {
  DeviceArray<std::uint64_t> cells;
  DeviceArray<std::uint32_t> where, first, group_end, heavy;
  DeviceArray<std::uint32_t> stage_rgba, stage_plane;
  DeviceArray<std::uint16_t> stage_normal;

  BatchArrays() = default;
  BatchArrays(DeviceHeap& heap, const FillSizes& sizes, FinestChannels channels)
      : cells(heap, sizes.items_per_batch),
        where(heap, sizes.items_per_batch),
        first(heap, sizes.pairs_per_batch),
        group_end(heap, sizes.pairs_per_batch / pairs_per_group + 1),
        heavy(heap, bricks_per_block * (sizes.pairs_per_batch / max_pairs_together + 1)),
        stage_rgba(heap, sizes.stage_voxels),
        stage_plane(heap, channels.planes ? sizes.stage_voxels : 0),
        stage_normal(heap, channels.normals ? sizes.stage_voxels : 0) {}
};

/// Returns a size of at least `needed`. A size that grows has an eighth to spare for the batches that follow.
std::uint32_t enlarged(std::uint32_t size, std::uint32_t needed) { return needed <= size ? size : needed + needed / 8; }

class Filler {
 public:
  Filler(DeviceHeap& heap, const InputView& input, SurfaceRule rule, const BrickLists& lists, FinestChannels channels,
         CellMaterials materials, const FillSizes& sizes)
      : heap_(heap),
        rule_(rule),
        lists_(lists),
        channels_(channels),
        materials_(materials),
        sizes_(sizes),
        marked_(heap, all_visible(materials) ? 0 : lists.bricks),
        place_(heap, all_visible(materials) ? 0 : lists.bricks),
        items_of_(heap, sizes.bricks_per_batch),
        hard_(heap, sizes.bricks_per_batch),
        is_easy_(heap, sizes.bricks_per_batch / bricks_per_block + 1),
        counters_(heap, 1),
        batch_(heap, sizes, channels) {
    out_.mask = DeviceArray<std::uint64_t>(heap_, 8 * std::size_t(lists.bricks));
    out_.count = DeviceArray<std::uint32_t>(heap_, lists.bricks + 1);
    out_.first = DeviceArray<std::uint32_t>(heap_, lists.bricks + 1);
    make_voxels();
    counters_.clear_to_zero();
    if (!all_visible(materials)) marked_.clear_to_zero();  // batches that do not fit leave it unchanged
    out_.count.clear_to_zero();
    out_.first.clear_to_zero();
    view_.input = input;
    set_views();
    const std::uint32_t batch = std::min(lists.bricks, sizes.bricks_per_batch);
    std::size_t more = 0;
    sum_visible(nullptr, temporary_bytes_, 0, batch);
    place(nullptr, more, 0, batch);
    temporary_bytes_ = std::max(temporary_bytes_, more);
    temporary_ = TemporaryStorage(heap, temporary_bytes_);
  }

  FilledBricks fill() {
    for (std::uint32_t begin = 0;; begin = enlarge()) {
      for (view_.begin = begin; view_.begin < lists_.bricks; view_.begin = view_.end) {
        view_.end = std::min(lists_.bricks, view_.begin + sizes_.bricks_per_batch);
        fill_batch();
      }
      heap_.bring(&out_.counted, counters_.data(), sizeof out_.counted, "filling bricks");
      if (out_.counted.is_stopped == 0) return std::move(out_);
    }
  }

 private:
  void make_voxels() {
    out_.rgba = DeviceArray<std::uint32_t>(heap_, sizes_.voxels);
    if (channels_.normals) out_.normal = DeviceArray<std::uint16_t>(heap_, sizes_.voxels);
    if (channels_.planes)
      out_.directional_coverage =
          DeviceArray<std::uint8_t>(heap_, directional_coverage_bytes * std::size_t(sizes_.voxels));
  }

  void set_views() {
    const bool at_once = all_visible(materials_);
    view_.bricks = {lists_.key.data(), lists_.start.data(), lists_.triangle.data()};
    view_.items = {batch_.cells.data(),      batch_.where.data(),          batch_.first.data(),
                   batch_.group_end.data(),  sizes_.items_per_batch,       sizes_.pairs_per_batch,
                   &counters_.data()->items, &counters_.data()->is_stopped};
    view_.mask = out_.mask.data();
    view_.visible = out_.count.data();
    view_.marked = at_once ? out_.count.data() : marked_.data();
    view_.place = at_once ? out_.first.data() : place_.data();
    view_.items_of = items_of_.data();
    view_.is_easy = is_easy_.data();
    view_.rgba = at_once ? out_.rgba.data() : batch_.stage_rgba.data();
    if (channels_.normals) view_.normal = at_once ? out_.normal.data() : batch_.stage_normal.data();
    if (channels_.planes) view_.plane = at_once ? out_.plane() : batch_.stage_plane.data();
    view_.capacity = at_once ? sizes_.voxels : sizes_.stage_voxels;
    view_.counters = counters_.data();
    view_.heavy = batch_.heavy.data();
    view_.hard = hard_.data();
    level_ = {out_.first.data(), out_.rgba.data(), out_.normal.data(), out_.plane(), sizes_.voxels};
  }

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
      launch_fill(materials_, view_, stream);
    } else {
      place(temporary_.data(), bytes, view_.begin, view_.end);
      launch_fill(materials_, view_, stream);
      bytes = temporary_bytes_;
      sum_visible(temporary_.data(), bytes, view_.begin, view_.end);
      launch_unstage(view_, level_, stream);
    }
    launch_finish(view_, level_, stream);
  }

  /// Enlarges the arrays that did not suffice. Returns the brick to continue with.
  std::uint32_t enlarge() {
    const BatchCounters& counted = out_.counted;
    if (counted.max_pairs > max_pairs_of_batch) throw DeviceFull("more than 2^26 triangle-brick pairs in one batch");
    if (counted.visible == std::numeric_limits<std::uint32_t>::max()) throw DeviceFull("more than 2^32-1 voxels");
    check_cuda(cudaMemsetAsync(&view_.counters->is_stopped, 0, sizeof counted.is_stopped, heap_.stream()),
               "cudaMemsetAsync");
    FillSizes larger = sizes_;
    larger.pairs_per_batch = std::min(enlarged(sizes_.pairs_per_batch, counted.max_pairs), max_pairs_of_batch);
    larger.items_per_batch = enlarged(sizes_.items_per_batch, counted.max_items);
    if (sizes_.stage_voxels != 0) larger.stage_voxels = enlarged(sizes_.stage_voxels, counted.max_staged);
    if (counted.visible > sizes_.voxels) larger.voxels = voxels_expected();
    const bool batch_grows = larger.pairs_per_batch != sizes_.pairs_per_batch ||
                             larger.items_per_batch != sizes_.items_per_batch ||
                             larger.stage_voxels != sizes_.stage_voxels;
    const bool level_grows = larger.voxels != sizes_.voxels;
    sizes_ = larger;
    if (batch_grows || level_grows) batch_ = BatchArrays();
    const std::uint32_t next = level_grows ? grow_voxels() : counted.next_brick;
    if (batch_grows || level_grows) batch_ = BatchArrays(heap_, sizes_, channels_);
    set_views();
    return next;
  }

  /// Returns the number of voxels of the level if its other bricks have as many voxels per pair as the finished bricks.
  std::uint32_t voxels_expected() const {
    constexpr double spare = 1.125;
    const BatchCounters& counted = out_.counted;
    const double per_pair = double(counted.finished_voxels) / std::max(1.0, double(counted.finished_pairs)),
                 expected = spare * per_pair * double(lists_.triangle.size()),
                 maximum =
                     std::min(double(brick_voxels) * lists_.bricks, double(std::numeric_limits<std::uint32_t>::max()));
    return std::uint32_t(std::min(std::max(expected, spare * counted.visible), maximum));
  }

  /// Moves the finished voxels to larger arrays. If the device has no memory for both, starts again with the first
  /// brick. Returns the brick to continue with.
  std::uint32_t grow_voxels() {
    const BatchCounters& counted = out_.counted;
    try {
      grow(out_.rgba, counted.finished_voxels, sizes_.voxels);
      grow(out_.normal, counted.finished_voxels, sizes_.voxels);
      grow(out_.directional_coverage, directional_coverage_bytes * std::size_t(counted.finished_voxels),
           directional_coverage_bytes * std::size_t(sizes_.voxels));
      return counted.next_brick;
    } catch (const DeviceFull&) {
      out_.rgba = {};
      out_.normal = {};
      out_.directional_coverage = {};
      make_voxels();
      counters_.clear_to_zero();
      return 0;
    }
  }

  template <class T>
  void grow(DeviceArray<T>& array, std::size_t kept, std::size_t size) {
    if (array.empty()) return;
    DeviceArray<T> larger(heap_, size);
    check_cuda(cudaMemcpyAsync(larger.data(), array.data(), kept * sizeof(T), cudaMemcpyDeviceToDevice, heap_.stream()),
               "cudaMemcpyAsync (voxels)");
    array = std::move(larger);
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
  const BrickLists& lists_;
  FinestChannels channels_;
  CellMaterials materials_;
  FillSizes sizes_;
  DeviceArray<std::uint32_t> marked_, place_, items_of_, hard_;
  DeviceArray<std::uint8_t> is_easy_;
  DeviceArray<BatchCounters> counters_;
  BatchArrays batch_;
  FilledBricks out_;
  BatchView view_{};
  FinestArrays level_{};
  std::size_t temporary_bytes_ = 0;
  TemporaryStorage temporary_;
};

}  // namespace

FilledBricks fill_bricks_of_level(DeviceHeap& heap, const InputView& input, SurfaceRule rule, const BrickLists& lists,
                                  FinestChannels channels, CellMaterials materials, const FillSizes& sizes) {
  return Filler(heap, input, rule, lists, channels, materials, sizes).fill();
}

}  // namespace gigabake::kernels
