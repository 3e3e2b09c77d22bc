/// A list of rays that a kernel continues, compacted to fill its warps.
#pragma once

#include <cstdint>

namespace gigabake::kernels {

/// Indices of rays of a tile, in no particular order.
struct RayList {
  std::uint32_t* rays;
  std::uint32_t* count;
};

/// Appends the rays of the lanes for which `is_in` is true. All lanes of the warp must call this function.
__device__ inline void append(bool is_in, std::uint32_t ray, const RayList& list) {
  const unsigned in = __ballot_sync(0xffffffffu, is_in ? 1 : 0);
  const unsigned lane = threadIdx.x % 32;
  std::uint32_t first = 0;
  if (lane == 0 && in != 0) first = atomicAdd(list.count, std::uint32_t(__popc(in)));
  first = __shfl_sync(0xffffffffu, first, 0);
  if (is_in) list.rays[first + std::uint32_t(__popc(in & ((1u << lane) - 1)))] = ray;
}

}  // namespace gigabake::kernels
