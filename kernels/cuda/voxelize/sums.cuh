/// Accumulators of a brick's voxels in shared memory.
///
/// Exact   The sum does not depend on the number and order of fragments. A sum is two or three 32-bit words with
///         carries, because shared memory has native atomic additions of 32 bits but not of 64 bits.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/host_device.h"
#include "kernels/body/voxelize/accumulate.h"
#include "kernels/body/voxelize/resolve.h"

namespace gigabake::kernels {

/// Sums of one voxel. A sum of 2 words (64 bits) suffices for bricks of at most fragments_before_flush triangles. A sum
/// of 3 words (96 bits) suffices for up to 2^32 triangles. `channels` is opaque_sum_count if all materials are opaque,
/// else sum_opaque. `sum_opaque` itself is one bit, in the word that makes the size odd.
template <int words, int channels>
struct VoxelSums {
  using Total = std::conditional_t<words == 2, std::int64_t, __int128>;

  static constexpr bool is_opaque = channels == opaque_sum_count;
  static constexpr int flag = words * channels;  ///< index of the word for `sum_opaque`
  static_assert(is_opaque || flag % 2 == 0);

  unsigned word[(words * channels) | 1];  ///< odd size: adjacent lanes use different banks

  __device__ void clear() {
    for (unsigned& w : word) w = 0;
  }

  /// Adds a fragment. Adds the low words of all channels first, then the next words with their carries. An upper word
  /// waits for the carry of the lower word, and the waits of the channels overlap in this order.
  __device__ void add(const Fragment& f) {
    std::uint64_t rest[sum_count];  // remainder for the next word and the words above it
    bool is_there[sum_count];
    for (bool& there : is_there) there = false;
    contribute(f, [&](Sum channel, std::int64_t value) {
      if (!is_opaque && channel == sum_opaque) atomicOr(&word[flag], 1u);
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
    s[sum_opaque] = is_opaque ? 1 : word[is_opaque ? 0 : flag];
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
    if (!is_third || part != 0) {  // the third word rarely changes
      const std::uint32_t before = atomicAdd(&word[at], part);
      carry = before + part < part;
    }
    rest = std::uint64_t(std::int64_t(rest) >> 32) + (carry ? 1 : 0);
  }
};

}  // namespace gigabake::kernels
