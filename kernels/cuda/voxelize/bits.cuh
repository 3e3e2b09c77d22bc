/// Selection in bit masks, with the same number of steps for every lane.
#pragma once

#include <cstdint>

namespace gigabake::kernels {

/// Returns the position of the n-th set bit.
/// Range   0 ≤ n < number of set bits; otherwise returns an arbitrary position.
__device__ inline int nth_bit(std::uint32_t bits, int n) {
  int at = 0;
#pragma unroll
  for (int half = 16; half != 0; half /= 2) {
    const int below = __popc(bits & ((1u << half) - 1));
    if (n < below) continue;
    n -= below;
    at += half;
    bits >>= half;
  }
  return at;
}

__device__ inline int nth_bit(std::uint64_t bits, int n) {
  const auto low = std::uint32_t(bits);
  const int below = __popc(low);
  const bool is_high = n >= below;
  return (is_high ? 32 : 0) + nth_bit(is_high ? std::uint32_t(bits >> 32) : low, is_high ? n - below : n);
}

}  // namespace gigabake::kernels
