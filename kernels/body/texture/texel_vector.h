/// The four channels of texels as vectors. Hosts use them in place of loops over channels, which compilers do not
/// turn into vector instructions where a texel has 16 bits per channel.
///
/// Exact   Integers: the same results as the loops.
#pragma once

#include <cstdint>
#include <cstring>

namespace gigabake::kernels {

#if defined(__GNUC__) && !defined(__CUDACC__)
#define GB_HAS_TEXEL_VECTOR 1

/// 32 bits per channel.
struct TexelVector {
  using Words = std::uint32_t __attribute__((vector_size(16)));
  using Signed = std::int32_t __attribute__((vector_size(16)));
  Words v;

  static TexelVector load(const std::uint32_t channels[4]) {
    TexelVector r;
    std::memcpy(&r.v, channels, sizeof r.v);
    return r;
  }
  /// Loads a texel with 16 bits per channel.
  static TexelVector widened(const std::uint16_t* texel) {
    using Longs = std::uint64_t __attribute__((vector_size(16)));
    using Halves = std::uint16_t __attribute__((vector_size(16)));
    std::uint64_t bits;
    std::memcpy(&bits, __builtin_assume_aligned(texel, 8), sizeof bits);
    const auto halves = reinterpret_cast<Halves>(Longs{bits, 0});
    return {reinterpret_cast<Words>(__builtin_shufflevector(halves, Halves{}, 0, 8, 1, 9, 2, 10, 3, 11))};
  }

  void store(std::uint32_t channels[4]) const { std::memcpy(channels, &v, sizeof v); }
  void add(const TexelVector& texel, std::uint32_t weight) { v += texel.v * weight; }

  /// Returns the means of add_filtered_sample() from its sums: shifted by `bits`, reduced by `offset` and limited to
  /// 0 … 65535. If `opaque`, alpha becomes 0; otherwise no channel exceeds alpha.
  template <bool opaque>
  TexelVector means(int bits, std::int32_t offset) const {
    const Signed zero{}, maximum = zero + 65535;
    Signed mean = reinterpret_cast<Signed>(v >> bits) - offset;
    mean = mean < zero ? zero : mean;
    mean = mean > maximum ? maximum : mean;
    if constexpr (opaque) return {reinterpret_cast<Words>(mean & Signed{-1, -1, -1, 0})};
    const Signed alpha = zero + mean[3];
    return {reinterpret_cast<Words>(mean < alpha ? mean : alpha)};
  }
};
#endif

}  // namespace gigabake::kernels
