/// Accumulators of a brick's voxels in shared memory.
///
/// Exact   Sums of any number of fragments, in any order. There is no 64-bit addition in shared memory: a sum is two or
///         three 32-bit words with carries, which the hardware adds by itself.
#pragma once

#include <cstdint>
#include <type_traits>

#include "kernels/body/accumulate.h"
#include "kernels/body/resolve.h"
#include "lattice/host_device.h"

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

  /// Lower words first: each upper one must wait for what its lower one answers, and they wait together.
  __device__ void add(const Fragment& f) {
    std::uint64_t rest[sum_count];  // what the next word and those above it get
    bool is_there[sum_count];
    for (bool& there : is_there) there = false;
    contribute(f, [&](Sum channel, std::int64_t value) {
      if (channel >= channels) return;
      is_there[channel] = true;
      rest[channel] = std::uint64_t(value);
    });
#pragma unroll
    for (int w = 0; w < words; ++w)
#pragma unroll
      for (int c = 0; c < channels; ++c)
        if (is_there[c]) add_word(words * c + w, rest[c]);
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
  __device__ void add_word(int at, std::uint64_t& rest) {
    const auto part = std::uint32_t(rest);
    const bool is_third = at % words == 2;
    bool carry = false;
    if (!is_third || part != 0) {  // the third word is nearly always left alone
      const std::uint32_t before = atomicAdd(&word[at], part);
      carry = before + part < part;
    }
    rest = std::uint64_t(std::int64_t(rest) >> 32) + (carry ? 1 : 0);
  }
};

}  // namespace gigabake::kernels
