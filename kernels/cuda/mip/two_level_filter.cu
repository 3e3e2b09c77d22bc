#include "kernels/body/mip/two_level_filter.h"
#include "kernels/cuda/mip/two_level_filter.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 128;

/// Returns the brick with this key, which must exist.
__device__ std::uint32_t brick_at(const TwoLevelFilter& in, std::uint32_t key) {
  std::uint32_t low = 0, high = in.bricks;
  while (high - low > 1) {
    const std::uint32_t middle = (low + high) / 2;
    (in.key[middle] <= key ? low : high) = middle;
  }
  return low;
}

/// Returns the index in the level of voxel x + 8y + 64z of a brick.
__device__ std::uint32_t index_of(const TwoLevelFilter& in, std::uint32_t brick, int voxel) {
  const std::uint64_t* mask = in.mask + 8 * std::size_t(brick);
  std::uint32_t before = in.first[brick];
  for (int z = 0; z < voxel >> 6; ++z) before += std::uint32_t(bit_count(mask[z]));
  return before + bits_below(mask[voxel >> 6], voxel & 63);
}

/// Computes one voxel per thread, from an octant of a brick that is two levels finer.
__global__ void __launch_bounds__(threads) filter_octants(TwoLevelFilter in, Tables tables) {
  const std::uint32_t i = blockIdx.x * threads + threadIdx.x, brick = i / 8;
  const int octant = int(i % 8);
  if (brick >= in.fine.bricks) return;
  const std::uint64_t* mask = in.fine.mask + 8 * std::size_t(brick);
  if (!has_voxels(mask, octant)) return;
  const auto voxel = [&](std::size_t at) {
    return unpack_voxel(in.fine.rgba[at], in.fine.normal == nullptr ? std::uint16_t(0) : in.fine.normal[at]);
  };
  const Voxel v = two_level_filter(mask, octant, in.fine.first[brick], voxel, tables);
  const std::uint32_t key = in.fine.key[brick];
  const std::uint32_t to =
      index_of(in, brick_at(in, std::uint32_t(grandparent_key(key))), grandparent_voxel(key, octant));
  in.out.put(to, {pack_rgba(v.rgba), 0, pack_normal(v.normal), {}, {}});
}

}  // namespace

void two_level_filter_level(DeviceHeap& heap, const TwoLevelFilter& level, const Tables& tables) {
  filter_octants<<<grid_of(8 * std::uint64_t(level.fine.bricks), threads), threads, 0, heap.stream()>>>(level, tables);
  check_launch("filter_octants");
}

}  // namespace gigabake::kernels
