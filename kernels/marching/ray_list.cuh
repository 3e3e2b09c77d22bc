/// A list of rays that a kernel continues, compacted to fill its warps.
#pragma once

#include <cstdint>

namespace gigabake::kernels {

/// Indices of rays of a tile, in no particular order.
struct RayList {
  std::uint32_t* rays;
  std::uint32_t* count;
};

/// A lane's place in a list, and the end of its warp's places.
struct ListPlace {
  std::uint32_t own, end;
};

/// Advances a counter by the number of lanes for which `is_in` is true, and gives each of them a place. All lanes of
/// the warp must call this function.
__device__ inline ListPlace take_place(bool is_in, std::uint32_t* count) {
  const unsigned in = __ballot_sync(0xffffffffu, is_in ? 1 : 0);
  const unsigned lane = threadIdx.x % 32;
  std::uint32_t first = 0;
  if (lane == 0 && in != 0) first = atomicAdd(count, std::uint32_t(__popc(in)));
  first = __shfl_sync(0xffffffffu, first, 0);
  return {first + std::uint32_t(__popc(in & ((1u << lane) - 1))), first + std::uint32_t(__popc(in))};
}

/// Appends the rays of the lanes for which `is_in` is true. All lanes of the warp must call this function.
__device__ inline void append(bool is_in, std::uint32_t ray, const RayList& list) {
  const ListPlace place = take_place(is_in, list.count);
  if (is_in) list.rays[place.own] = ray;
}

}  // namespace gigabake::kernels
