#include <algorithm>
#include <limits>

#include "core/base/rules.h"
#include "core/octree/brick.h"
#include "kernels/cuda/voxelize/filler.cuh"
#include "kernels/cuda/voxelize/select.cuh"
#include "kernels/cuda/voxelize/voxelize.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256;

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

/// Removes the bricks without a visible voxel.
DeviceLevel without_empty(DeviceHeap& heap, const BrickLists& lists, FilledBricks filled) {
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
constexpr std::uint64_t min_pairs_per_batch = std::uint64_t(1) << 17, pairs_per_batch = std::uint64_t(1) << 20,
                        voxels_per_batch = std::uint64_t(3) << 20;
constexpr double min_bricks_per_batch = 660;
/// Factors over the expected sizes, so that arrays rarely have to grow. The arrays of a batch are small, and cells
/// differ.
constexpr double spare = 1.125, batch_spare = 1.5;

std::uint32_t counted_32(std::uint64_t n) {
  if (n > std::numeric_limits<std::uint32_t>::max()) throw DeviceFull("more than 2^32-1 voxels");
  return std::uint32_t(n);
}

std::uint32_t with_capacity(double wanted, std::uint64_t minimum) {
  return counted_32(std::max(std::uint64_t(wanted), minimum));
}

/// Returns the max number of pairs per batch. The batch's items and staging arrays use the memory that the cell's
/// voxels leave.
std::uint64_t pairs_that_fit(const BrickLists& lists, const FillRatios& ratios, bool at_once,
                             std::size_t bytes_of_voxel, double capacity_bytes) {
  const double pairs = double(lists.triangle.size()), voxel_bytes = double(bytes_of_voxel),
               item_bytes = sizeof(std::uint64_t) + sizeof(std::uint32_t), mask_bytes = 64 + 2 * sizeof(std::uint32_t);
  const double kept = mask_bytes * lists.bricks + spare * voxel_bytes * ratios.voxels_per_pair * pairs,
               of_pair =
                   batch_spare * (ratios.pairs_spread * ratios.items_per_pair * item_bytes + sizeof(std::uint32_t) +
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
  s.pairs_per_batch =
      std::min(with_capacity(batch_spare * double(batch) * ratios.pairs_spread, pairs_per_group), max_pairs_of_batch);
  s.items_per_batch = with_capacity(batch_spare * double(batch) * ratios.pairs_spread * ratios.items_per_pair, 1024);
  s.voxels = with_capacity(
      std::min(spare * double(pairs) * ratios.voxels_per_pair, double(brick_voxels) * lists.bricks), 1024);
  s.stage_voxels =
      at_once
          ? 0
          : std::min(s.voxels,
                     with_capacity(batch_spare * double(batch) * ratios.voxels_per_pair * ratios.voxels_spread, 1024));
  return s;
}

/// Sets the ratios from which the next cell computes the sizes of its arrays.
void learn(const FilledBricks& filled, const BrickLists& lists, const FillSizes& sizes, FillRatios& ratios) {
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
  const FillSizes sizes = first_sizes(lists, ratios, all_visible(materials), channels.bytes(),
                                      double(capacity_bytes) - double(heap.live()));
  FilledBricks filled = fill_bricks_of_level(heap, input, window.rule, lists, channels, materials, sizes);
  counted_32(filled.counted.voxels);
  stats.fragments += filled.counted.fragments;
  learn(filled, lists, sizes, ratios);
  return without_empty(heap, lists, std::move(filled));
}

}  // namespace gigabake::kernels
