#include <algorithm>

#include "core/octree/morton.h"
#include "kernels/body/mip/level_voxel.h"
#include "kernels/cuda/mip/hash.cuh"
#include "kernels/cuda/voxelize/bits.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, max_blocks = 2048;

struct HashView {
  const std::uint32_t *key, *first, *rgba;
  const std::uint64_t* mask;
  const std::uint16_t* normal;               ///< null if the level has none
  const std::uint8_t* directional_coverage;  ///< null if the level has none
  std::uint32_t bricks;
  Vec3i64 window_min;
  int lod;
};

/// Returns the bit (0 … 511) of voxel number `rank` of a brick. `word` is this lane's 32 bits of the mask, and `before`
/// is the number of voxels in the words of lower lanes. Lanes 16 to 31 own no word. All lanes must call it.
__device__ int voxel_bit(std::uint32_t word, int before, int rank) {
  int at = 0;
#pragma unroll
  for (int half = 8; half != 0; half /= 2)
    if (__shfl_sync(~0u, before, at + half) <= rank) at += half;
  const std::uint32_t bits = __shfl_sync(~0u, word, at);
  return 32 * at + nth_bit(bits, rank - __shfl_sync(~0u, before, at));
}

__device__ Hash128 brick_hash(const HashView& level, std::uint32_t brick, int lane) {
  const auto* words = reinterpret_cast<const std::uint32_t*>(level.mask + 8 * std::size_t(brick));
  const std::uint32_t word = lane < 16 ? words[lane] : 0;
  int before = __popc(word);
#pragma unroll
  for (int d = 1; d < 16; d *= 2) {
    const int lower = __shfl_up_sync(~0u, before, d);
    if (lane >= d) before += lower;
  }
  before -= __popc(word);
  const BrickCoordinate at = demorton(level.key[brick]);
  const std::uint32_t first = level.first[brick], end = level.first[brick + 1];
  Hash128 sum;
  for (std::uint32_t step = first; step < end; step += 32) {
    const std::uint32_t i = step + std::uint32_t(lane);
    const int bit = voxel_bit(word, before, int(i - first));
    if (i >= end) continue;
    sum += hash_of_voxel(level.window_min, level.lod, at, bit, level.rgba[i],
                         level.normal == nullptr ? std::uint16_t(0) : level.normal[i],
                         level.directional_coverage == nullptr
                             ? nullptr
                             : level.directional_coverage + directional_coverage_bytes * std::size_t(i));
  }
  return sum;
}

/// Hashes one brick per warp.
__global__ void __launch_bounds__(threads, 6) hash_level(HashView level, Hash128* total) {
  const int lane = int(threadIdx.x & 31);
  Hash128 sum;
  for (std::uint32_t brick = (blockIdx.x * blockDim.x + threadIdx.x) / 32; brick < level.bricks;
       brick += gridDim.x * blockDim.x / 32)
    sum += brick_hash(level, brick, lane);
#pragma unroll
  for (int d = 16; d != 0; d /= 2) sum += Hash128{__shfl_down_sync(~0u, sum.lo, d), __shfl_down_sync(~0u, sum.hi, d)};
  if (lane != 0) return;
  auto* words = reinterpret_cast<unsigned long long*>(total);
  const unsigned long long lo = atomicAdd(&words[0], (unsigned long long)(sum.lo));
  atomicAdd(&words[1], (unsigned long long)(sum.hi + (lo + sum.lo < lo ? 1 : 0)));
}

}  // namespace

std::vector<Hash128> level_hashes(DeviceHeap& heap, const std::vector<DeviceLevel>& levels, const Vec3i64& window_min) {
  DeviceArray<Hash128> sums(heap, levels.size());
  sums.clear_to_zero();
  for (std::size_t lod = 0; lod < levels.size(); ++lod) {
    const DeviceLevel& l = levels[lod];
    const HashView view{l.key.data(),
                        l.first.data(),
                        l.rgba.data(),
                        l.mask.data(),
                        l.normal.empty() ? nullptr : l.normal.data(),
                        l.directional_coverage.empty() ? nullptr : l.directional_coverage.data(),
                        l.bricks,
                        window_min,
                        int(lod)};
    hash_level<<<std::min(grid_of(32 * std::uint64_t(l.bricks), threads), max_blocks), threads, 0, heap.stream()>>>(
        view, sums.data() + lod);
    check_launch("hash_level");
  }
  std::vector<Hash128> hashes(levels.size());
  heap.bring(hashes.data(), sums.data(), sums.bytes(), "content hashes");
  return hashes;
}

}  // namespace gigabake::kernels
