/// Rays of a tile that a kernel goes on with, so that its warps are full of them.
#pragma once

#include <cstdint>

namespace gigabake::kernels {

/// Rays of a tile, by their indices, in no order.
struct RayList {
  std::uint32_t* rays;
  std::uint32_t* count;
};

/// Adds the rays of a warp's lanes that `is_in`. All lanes call this.
__device__ inline void append(bool is_in, std::uint32_t ray, const RayList& list) {
  const unsigned in = __ballot_sync(0xffffffffu, is_in ? 1 : 0);
  const unsigned lane = threadIdx.x % 32;
  std::uint32_t first = 0;
  if (lane == 0 && in != 0) first = atomicAdd(list.count, std::uint32_t(__popc(in)));
  first = __shfl_sync(0xffffffffu, first, 0);
  if (is_in) list.rays[first + std::uint32_t(__popc(in & ((1u << lane) - 1)))] = ray;
}

}  // namespace gigabake::kernels
