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
/// of 3 words (96 bits) suffices for up to 2^32 triangles. Narrow sums need one word less. `channels` is
/// opaque_sum_count if all materials are opaque, else sum_count.
template <int words, int channels>
struct VoxelSums {
  using Total = std::conditional_t<words == 2, std::int64_t, __int128>;

  /// Returns the number of words of a channel's sum.
  static constexpr int words_of(int channel) { return is_narrow_sum(channel) ? words - 1 : words; }
  /// Returns the index of the lowest word of a channel's sum.
  static constexpr int word_of(int channel) {
    int word = 0;
    for (int c = 0; c < channel; ++c) word += words_of(c);
    return word;
  }

  unsigned word[word_of(channels) | 1];  ///< odd size: adjacent lanes use different banks

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
      if (channel >= channels) return;
      if (words_of(channel) == 1) {
        atomicAdd(&word[word_of(channel)], std::uint32_t(value));  // has no carry, so nothing waits for it
        return;
      }
      is_there[channel] = true;
      rest[channel] = std::uint64_t(value);
    });
#pragma unroll
    for (int w = 0; w < words; ++w)
#pragma unroll
      for (int c = 0; c < channels; ++c)
        if (is_there[c] && w < words_of(c)) add_word(word_of(c) + w, w == 2, rest[c]);
  }

  __device__ bool resolve_to(const Tables& tables, FinestVoxel& out) const {
    Total s[sum_count];
    s[sum_clear] = 0;
    s[sum_opaque] = 1;
#pragma unroll
    for (int c = 0; c < channels; ++c) s[c] = sum_of(word + word_of(c), words_of(c));
    return resolve(s, tables, out);
  }

 private:
  /// Returns the sum of `count` words, the lowest first.
  __device__ static Total sum_of(const unsigned* at, int count) {
    if (count == 1) return std::int32_t(at[0]);
    const auto low = std::int64_t(std::uint64_t(at[1]) << 32 | at[0]);
    if constexpr (words == 3)
      if (count == 3) return __int128(std::int32_t(at[2])) * (__int128(1) << 64) + __int128(std::uint64_t(low));
    return low;
  }

  __device__ void add_word(int at, bool is_third, std::uint64_t& rest) {
    const auto part = std::uint32_t(rest);
    bool carry = false;
    if (!is_third || part != 0) {  // the third word rarely changes
      const std::uint32_t before = atomicAdd(&word[at], part);
      carry = before + part < part;
    }
    rest = std::uint64_t(std::int64_t(rest) >> 32) + (carry ? 1 : 0);
  }
};

}  // namespace gigabake::kernels
