/// The eight interpolation taps of a point as vectors with one lane per tap. Hosts use them in place of loops over the
/// existing voxels, which compilers do not turn into vector instructions.
///
/// Exact   Each lane computes what the loop computes for its voxel, in the same order. Sums add the lanes in ascending
///         order. Missing taps add zeros, which change no bit: sums begin at +0 and are therefore never -0.
#pragma once

#include <cstdint>
#include <cstring>

#include "kernels/marching/sample.h"

// Without AVX2 the loops are faster.
#if defined(__AVX2__) && !defined(__CUDACC__)
#define GB_HAS_TAP_VECTORS 1

#include <immintrin.h>

namespace gigabake::kernels {

using TapInts = std::int32_t __attribute__((vector_size(32)));
using TapFloats = float __attribute__((vector_size(32)));

/// Returns a mask of the lanes whose highest bit is set (bit c: lane c).
inline std::uint32_t lanes_in(const TapInts& v) {
  return std::uint32_t(_mm256_movemask_ps(reinterpret_cast<__m256>(v)));
}

inline TapFloats square_root(const TapFloats& v) {
  return reinterpret_cast<TapFloats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(v)));
}

/// Adds the lanes of rows[k] to sums[k], in ascending order.
inline void sum_lanes(const TapFloats (&rows)[8], float (&sums)[8]) {
  TapFloats pair[8], four[8];
  for (int k = 0; k < 8; k += 2) {
    pair[k] = __builtin_shufflevector(rows[k], rows[k + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    pair[k + 1] = __builtin_shufflevector(rows[k], rows[k + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (int k = 0; k < 8; k += 4)
    for (int half = 0; half < 2; ++half) {
      const TapFloats &a = pair[k + half], &b = pair[k + half + 2];
      four[k + 2 * half] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
      four[k + 2 * half + 1] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    }
  TapFloats sum;
  std::memcpy(&sum, sums, sizeof sum);
  for (int lane = 0; lane < 4; ++lane)
    sum += __builtin_shufflevector(four[lane], four[lane + 4], 0, 1, 2, 3, 8, 9, 10, 11);
  for (int lane = 0; lane < 4; ++lane)
    sum += __builtin_shufflevector(four[lane], four[lane + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  std::memcpy(sums, &sum, sizeof sum);
}

/// The taps of a point. Lanes of missing taps hold the bits of any voxel or layer.
struct TapVectors {
  TapInts is_there;  ///< all bits of a lane are set if the tap has a voxel
  TapInts word[3];   ///< the words of PackedVoxel
  TapFloats weight;  ///< CastCorners::weight(); 0 for missing taps

  /// Loads the taps.
  /// Range   `there` is corners.there() and not 0.
  TapVectors(const CastCorners& corners, std::uint32_t there) {
    const TapInts bits{1, 2, 4, 8, 16, 32, 64, 128};
    is_there = ((TapInts{} + std::int32_t(there)) & bits) == bits;
    Quad half[2][3];
    load_layer(corners.voxels, corners.low, half[0]);
    load_layer(corners.voxels, corners.high, half[1]);
    for (int k = 0; k < 3; ++k) word[k] = __builtin_shufflevector(half[0][k], half[1][k], 0, 1, 2, 3, 4, 5, 6, 7);
    const float x = corners.between[0], y = corners.between[1], z = corners.between[2];
    const float lower_x = 1 - x, lower_y = 1 - y, lower_z = 1 - z;
    const TapFloats in_x{lower_x, x, lower_x, x, lower_x, x, lower_x, x},
        in_y{lower_y, lower_y, y, y, lower_y, lower_y, y, y}, in_z{lower_z, lower_z, lower_z, lower_z, z, z, z, z};
    weight = existing(in_x * in_y * in_z);
  }

  /// Returns `v` with zeros in the lanes of missing taps.
  TapFloats existing(const TapFloats& v) const {
    return reinterpret_cast<TapFloats>(reinterpret_cast<TapInts>(v) & is_there);
  }
  /// Returns a coverage of CastVoxel in 1/255; exact in a float.
  TapFloats coverage(int axis) const {
    return __builtin_convertvector((axis == 2 ? word[2] : word[1] >> (16 + 8 * axis)) & 255, TapFloats);
  }
  /// Returns channel `k` of CastVoxel::c.
  TapFloats channel(int k) const {
    if (k >= 3) return coverage(k - 3) * 257;
    return __builtin_convertvector((k == 1 ? word[0] >> 16 : word[k / 2]) & 65535, TapFloats);
  }
  TapInts plane() const { return word[2] >> 24 & 127; }
  /// Returns the offsets of the planes; 0 without a plane.
  TapFloats plane_offset() const {
    return __builtin_convertvector((plane() & 3) != 0 ? (plane() >> 2 & 15) - 8 : 0, TapFloats);
  }
  /// Returns blend_weight() of the voxels.
  TapFloats blend_weight() const {
    const TapFloats covered = (coverage(0) + coverage(1) + coverage(2)) * 257;
    return __builtin_convertvector(word[2] >> 24 & 3, TapFloats) * covered * (1.0f / (3 * 65535));
  }
  /// Returns the sum of the voxels' channels, each voxel multiplied by its lane of `by`.
  CastSample sum_channels(const TapFloats& by) const {
    TapFloats rows[8];
    for (int k = 0; k < cast_channels; ++k) rows[k] = by * channel(k);
    rows[6] = rows[7] = TapFloats{};
    float sums[8] = {};
    sum_lanes(rows, sums);
    CastSample r;
    for (int k = 0; k < cast_channels; ++k) r.c[k] = sums[k];
    return r;
  }

 private:
  using Quad = std::int32_t __attribute__((vector_size(16)));
  using Longs = std::int64_t __attribute__((vector_size(16)));

  static std::int64_t last_words(const PackedVoxel* at) {
    std::int64_t words;
    std::memcpy(&words, at->word + 1, sizeof words);
    return words;
  }
  /// Loads the words of a layer's four taps.
  static void load_layer(const PackedVoxel* voxels, const LayerWindow& layer, Quad (&words)[3]) {
    const std::uint32_t next_row = layer.bits >> slot_edge;
    const PackedVoxel* const a = voxels + ((layer.bits & 3) != 0 ? layer.first : 0);
    const PackedVoxel* const b = a + ((layer.bits & 3) == 3 ? 1 : 0);
    const PackedVoxel* const c = voxels + ((next_row & 3) != 0 ? layer.second : 0);
    const PackedVoxel* const d = c + ((next_row & 3) == 3 ? 1 : 0);
    words[0] =
        Quad{std::int32_t(a->word[0]), std::int32_t(b->word[0]), std::int32_t(c->word[0]), std::int32_t(d->word[0])};
    const auto row = reinterpret_cast<Quad>(Longs{last_words(a), last_words(b)});
    const auto next = reinterpret_cast<Quad>(Longs{last_words(c), last_words(d)});
    words[1] = __builtin_shufflevector(row, next, 0, 2, 4, 6);
    words[2] = __builtin_shufflevector(row, next, 1, 3, 5, 7);
  }
};

/// Three floats per tap.
struct TapNormals {
  TapFloats x, y, z;

  /// Decodes the normals of the voxels; 0 without a normal and for missing taps.
  explicit TapNormals(const TapVectors& taps) {
    const TapInts a = taps.word[2] << 16 >> 24, b = taps.word[2] << 8 >> 24, behind = taps.word[2] >> 31;
    const TapInts is_there = taps.is_there & (a != no_normal);
    const TapInts across = (127 - (a < 0 ? -a : a)) - (b < 0 ? -b : b);
    x = __builtin_convertvector(a & is_there, TapFloats);
    y = __builtin_convertvector(b & is_there, TapFloats);
    z = __builtin_convertvector(((across ^ behind) - behind) & is_there, TapFloats);
  }

  /// Returns the dot products of integer vectors; exact in a float.
  TapFloats dot(const TapFloats& a, const TapFloats& b, const TapFloats& c) const { return (x * a + y * b) + z * c; }
  TapFloats dot(const Vec3<float>& v) const { return dot(TapFloats{} + v[0], TapFloats{} + v[1], TapFloats{} + v[2]); }
  TapFloats squared_length() const { return dot(x, y, z); }
  Vec3<float> of_lane(int c) const { return {x[c], y[c], z[c]}; }

  /// Returns length_along() per lane.
  TapFloats length_along(const Vec3d& direction) const {
    using Doubles = double __attribute__((vector_size(32)));
    using Floats = float __attribute__((vector_size(16)));
    const auto widened = [](const TapFloats& v, bool is_upper) {
      const Floats half =
          is_upper ? __builtin_shufflevector(v, v, 4, 5, 6, 7) : __builtin_shufflevector(v, v, 0, 1, 2, 3);
      return __builtin_convertvector(half, Doubles);
    };
    Floats along[2];
    for (int half = 0; half < 2; ++half) {
      const bool is_upper = half == 1;
      along[half] =
          __builtin_convertvector((direction[0] * widened(x, is_upper) + direction[1] * widened(y, is_upper)) +
                                      direction[2] * widened(z, is_upper),
                                  Floats);
    }
    const TapFloats squared = squared_length();
    const TapFloats both = __builtin_shufflevector(along[0], along[1], 0, 1, 2, 3, 4, 5, 6, 7);
    const TapFloats across = (both < 0 ? -both : both) / square_root(squared);
    return squared > 0 ? across : TapFloats{} + 1;
  }
};

}  // namespace gigabake::kernels
#endif
