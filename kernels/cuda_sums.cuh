/// Accumulators of a brick's voxels in shared memory.
///
/// Exact   Sums of any number of fragments, in any order. There is no 64-bit addition in shared memory: a sum is two or
///         three 32-bit words with carries, which the hardware adds by itself.
#pragma once

#include <cstdint>
#include <type_traits>

#include "kernels/accumulate.h"
#include "kernels/resolve.h"
#include "kernels/types.h"

namespace gigabake::kernels {

/// Of one voxel. words 2: 64 bits, for bricks of at most fragments_before_flush triangles. words 3: 96 bits, for 2^32
/// triangles. channels: opaque_sum_count where all is opaque, else sum_count.
template <int words, int channels>
struct VoxelSums {
  using Total = std::conditional_t<words == 2, std::int64_t, __int128>;

  unsigned word[(words * channels) | 1];  ///< an odd number: neighbours in a warp use different banks

  __device__ void clear() {
    for (unsigned& w : word) w = 0;
  }

  __device__ void add(const Fragment& f) {
    contribute(f, [&](Sum channel, std::int64_t value) {
      if (channel < channels) add(channel, value);
    });
  }

  __device__ bool resolve_to(const Tables& tables, Voxel& out) const {
    Total s[sum_count];
    s[sum_clear] = 0;
    for (int c = 0; c < channels; ++c) {
      const unsigned* at = word + words * c;
      const std::int64_t low = std::int64_t(std::uint64_t(at[1]) << 32 | at[0]);
      if constexpr (words == 2)
        s[c] = low;
      else
        s[c] = __int128(std::int32_t(at[2])) * (__int128(1) << 64) + __int128(std::uint64_t(low));
    }
    return resolve(s, tables, out);
  }

 private:
  __device__ void add(int channel, std::int64_t value) {
    std::uint64_t rest = std::uint64_t(value);  // what this word and those above it get
    const std::uint64_t sign = value < 0 ? ~std::uint64_t(0) << 32 : 0;
#pragma unroll
    for (int w = 0; w < words; ++w) {
      const auto part = std::uint32_t(rest);
      bool carry = false;
      if (w < 2 || part != 0) {  // the third word is nearly always left alone
        const std::uint32_t before = atomicAdd(&word[words * channel + w], part);
        carry = before + part < part;
      }
      rest = (rest >> 32 | sign) + (carry ? 1 : 0);
    }
  }
};

}  // namespace gigabake::kernels
