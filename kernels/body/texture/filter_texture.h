/// Mean of one level of a texture over a small footprint, from three texels along each axis.
///
/// The weights of nine texels have the mean and covariance of the footprint. Their variances are the footprint's
/// variances, widened as linear interpolation between two texels widens a point. The result for a quadratic texture is
/// therefore its exact mean. The results for pieces of a voxel sum to the result for the whole voxel. Along an axis,
/// the result for a box of up to one texel is the mean of linear interpolation over the box.
///
/// Space   Texels of one level.
/// Exact   Weights are computed in IEEE floats and rounded to integers with sum 2^15. Host and device agree, and a
///         uniform colour is preserved.
/// Range   Boxes with edges up to the root of `max_width_squared`; a wider box is replaced by the widest box that fits.
/// Cost    Nine texels.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/base/host_device.h"
#include "kernels/body/texture/sample_texture.h"
#include "kernels/body/texture/texel_vector.h"
#include "kernels/body/voxelize/brick_triangle.h"

namespace gigabake::kernels {

/// Returns the nearest integer. Adding 1.5 · 2^23 leaves a float no bits for fractions; this rounding is fast on a
/// device.
/// Range   |x| ≤ 2^21.
GB_HD std::int32_t rounded(float x) {
  const float whole = x + 12582912.0f;  // 1.5 · 2^23
  std::int32_t bits;
  std::memcpy(&bits, &whole, sizeof bits);
  return bits - 0x4b400000;
}

/// Squared edge of the widest box that three texels represent. A wider box would mostly give the middle texel a
/// negative weight.
inline constexpr float max_width_squared = 7.5f;

/// Footprint on one level: the squared edges of a box, and a covariance, both in texels². A negative squared edge
/// describes a footprint narrower than the level's texels; its filter sharpens.
struct LevelFootprint {
  float width_squared, height_squared, covariance;
};

/// Position of a sample on an image.
struct ImagePosition {
  std::int64_t at;  ///< in units of 2^-32 of the image
  bool is_turned;   ///< the image is mirrored at this position
};

/// Returns the position of s on the image. For clamp_to_edge, positions up to half an image beyond the edge are kept,
/// because a footprint may cross the edge.
GB_HD ImagePosition image_position(double s, Wrap wrap) {
  if (wrap != Wrap::clamp_to_edge) {
    const bool is_turned = wrap == Wrap::mirrored_repeat && low_word(s + 3145728.0) >> 31 != 0;
    return {std::int64_t(fraction_of(s, wrap)), is_turned};
  }
  const double from_middle = s - 0.5, within = from_middle < -1 ? -1 : (from_middle > 0.999 ? 0.999 : from_middle);
  return {(std::int64_t(std::int32_t(low_word(within + 3145728.0))) + (std::int64_t(1) << 30)) * 2, false};
}

/// Three texels along an axis and their weights; `slope` is the derivative of the weights' second moment by their
/// first.
struct AxisTaps {
  std::int32_t texel[3], weight[3];
  float slope;
};

/// Returns the index in the image of texel i of the wrapped row.
/// Range   -size ≤ i < 2·size.
GB_HD std::int32_t texel_near(std::int32_t i, std::int32_t size, bool repeats) {
  if (i < 0) return repeats ? i + size : 0;
  return i < size ? i : (repeats ? i - size : size - 1);
}

/// Returns 1/√x for any x > 0. The relative error is below 0.2 %, which suffices for weights.
GB_HD float inverse_root(float x) {
  std::int32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits = 0x5f3759df - (bits >> 1);
  float r;
  std::memcpy(&r, &bits, sizeof r);
  return r * (1.5f - 0.5f * x * r * r);
}

/// Moments of the weights about the middle texel; `slope` is the derivative of the second moment by the first.
struct AxisMoments {
  float first, second, slope;
};

/// Returns the moments of linear interpolation averaged over a box with centre `m`, in texels from the middle texel's
/// centre. The second moment is exact on the image for boxes of up to one texel. Otherwise it is a parabola in `m`.
GB_HD AxisMoments axis_moments(float m, float width_squared, bool is_image) {
  if (width_squared >= 1 || !is_image) return {m, smaller(m * m + (width_squared + 2) * (1.0f / 12), 1.0f), 2 * m};
  if (width_squared <= 4 * m * m) return {m, std::fabs(m), m < 0 ? -1.0f : 1.0f};
  const float inverse = inverse_root(width_squared), near = m * inverse;
  return {m, m * near + 0.25f * width_squared * inverse, 2 * near};
}

inline constexpr int weight_s_bits = 8, weight_t_bits = 7, slope_s_bits = 5,
                     slope_t_bits = weight_s_bits + weight_t_bits - slope_s_bits;

/// Returns the three texels around position `at` and their weights, which sum to 2^bits. `at` is in units of 2^-32 of
/// the image. `is_image` is true for level 0, which is the image itself.
template <int bits>
GB_HD AxisTaps axis_taps(std::int64_t at, std::int32_t size, Wrap wrap, bool is_image, float width_squared) {
  const std::int64_t place = at * size;
  const auto middle = std::int32_t(place >> 32);
  const float from_middle = float(std::int32_t(std::uint32_t(place) ^ 0x80000000u)) * (1.0f / 4294967296.0f);
  const AxisMoments m = axis_moments(from_middle, width_squared, is_image);
  AxisTaps r;
  for (int k = 0; k < 3; ++k) r.texel[k] = middle + k - 1;
  if (middle < 1 || middle > size - 2)  // some texels lie outside the image
    for (int k = 0; k < 3; ++k) r.texel[k] = texel_near(r.texel[k], size, wrap == Wrap::repeat);
  constexpr float half = float(1 << (bits - 1));
  r.weight[0] = rounded((m.second - m.first) * half);
  r.weight[2] = rounded((m.second + m.first) * half);
  r.weight[1] = (1 << bits) - r.weight[0] - r.weight[2];
  r.slope = m.slope;
  return r;
}

/// Change of the weights if the footprint moves by one texel; the changes sum to 0.
struct AxisSlopes {
  std::int32_t of[3];
};

/// Returns the change of the weights as fixed-point numbers, in which `scale` represents 1.
GB_HD AxisSlopes axis_slopes(const AxisTaps& taps, float scale) {
  const std::int32_t before = rounded((taps.slope - 1) * (0.5f * scale)),
                     after = rounded((taps.slope + 1) * (0.5f * scale));
  return {{before, -before - after, after}};
}

/// Initial values of weighted sums: a half for rounding, and an offset that keeps sums non-negative when a covariance
/// subtracts texels. The result may still lie below black or above white; channel_of() clamps it.
inline constexpr int sum_bits = weight_s_bits + weight_t_bits;
inline constexpr std::uint32_t sum_start = 1u << (sum_bits + 15), sum_half = 1u << (sum_bits - 1);

GB_HD std::uint16_t channel_of(std::uint32_t sum) {
  const auto mean = std::int32_t(sum >> sum_bits) - std::int32_t(sum_start >> sum_bits);
  return std::uint16_t(mean < 0 ? 0 : smaller(mean, 65535));
}

GB_HD float half_square(float x) { return x > 0 ? 0.5f * x * x : 0; }

/// Returns the fraction of a box that passes the alpha test. Alpha is a linear function over the box. At the box's
/// centre it exceeds the cutoff by `beyond`. It changes by `along` along one edge and by `across` along the other.
GB_HD float passing_fraction(float beyond, float along, float across) {
  const float longer = larger(larger(along, across), 1.0f), shorter = larger(smaller(along, across), longer / 64);
  const float far = 0.5f * (longer + shorter), near = 0.5f * (longer - shorter);
  // If the whole box lies on one side of the cutoff, the differences of squares below would cancel. Uniform alpha
  // passes if it equals the cutoff.
  if (beyond >= far || (beyond >= 0 && along + across == 0)) return 1;
  if (beyond <= -far) return 0;
  const float share = ((half_square(beyond + far) - half_square(beyond + near)) -
                       (half_square(beyond - near) - half_square(beyond - far))) /
                      (longer * shorter);
  return larger(0.0f, smaller(share, 1.0f));
}

/// Applies the alpha test to the mean colour of a box, over which a renderer would test each point. The passing
/// fraction is computed for an alpha that is linear over the box, with the changes `along` and `across`.
/// Range   alpha is not 0.
GB_HD_NOINLINE Rgba16 test_box(Rgba16 mean, std::uint8_t cutoff, float along, float across) {
  const float share = passing_fraction(float(int(mean.c[3]) - int(cutoff * 257u)), along, across);
  const auto alpha = std::uint32_t(rounded(share * 65535));
  Rgba16 r;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t straight = (mean.c[c] * 65535u + mean.c[3] / 2u) / mean.c[3];
    r.c[c] = scale16(smaller(straight, 65535u), alpha);
  }
  r.c[3] = std::uint16_t(alpha);
  return r;
}

/// Change of alpha if the footprint moves by one texel: along s in units of 2^-12, along t in units of 2^-13.
struct AlphaSlopes {
  std::int32_t s, t;
};

/// Applies the alpha test to a slanted footprint. Its alpha varies more or less than that of a box, so the box is
/// scaled to the same variation.
GB_HD Rgba16 test_footprint(const Rgba16& mean, std::uint8_t cutoff, const AlphaSlopes& slopes,
                            const LevelFootprint& footprint) {
  const float s = float(slopes.s) * (1.0f / 4096), t = float(slopes.t) * (1.0f / 8192);
  const float along = std::fabs(s) * std::sqrt(footprint.width_squared),
              across = std::fabs(t) * std::sqrt(footprint.height_squared);
  const float squares = larger(along * along + across * across, 1.0f);
  const float scale = std::sqrt(larger(0.0f, 1 + 24 * s * t * footprint.covariance / squares));
  return test_box(mean, cutoff, along * scale, across * scale);
}

/// Texels of a footprint along both axes, and the parameters of their weights.
struct FootprintTaps {
  AxisTaps across, down;
  AxisSlopes columns, rows;

  GB_HD std::uint32_t weight(int column, int row) const {
    return std::uint32_t(across.weight[column] * down.weight[row] + columns.of[column] * rows.of[row]);
  }
};

#if defined(GB_HAS_TEXEL_VECTOR)
/// Returns the sums of add_filtered_sample() over the nine texels of a level ≥ 1 of `width` texels.
inline TexelVector sum_of_texels(const std::uint16_t* level, std::int32_t width, const FootprintTaps& taps) {
  constexpr std::uint32_t start = sum_start + sum_half;
  TexelVector sum{{start, start, start, start}};
  for (int j = 0; j < 3; ++j) {
    const std::uint32_t row = std::uint32_t(taps.down.texel[j]) * std::uint32_t(width);
    for (int k = 0; k < 3; ++k)
      sum.add(TexelVector::widened(level + 4 * std::size_t(row + std::uint32_t(taps.across.texel[k]))),
              taps.weight(k, j));
  }
  return sum;
}

/// Adds the means that follow from the sums of add_filtered_sample() to `total`.
template <bool opaque>
void add_means(const TexelVector& sum, std::uint32_t total[4]) {
  TexelVector all = TexelVector::load(total);
  all.add(sum.means<opaque>(sum_bits, sum_start >> sum_bits), 1);
  all.store(total);
}
#endif

/// Adds the nine weighted texels of level l to the sums. If `is_tested`, also adds the changes of alpha.
template <bool opaque>
GB_HD void add_texels(const TextureView& view, int l, std::int32_t width, const FootprintTaps& taps, bool is_tested,
                      const Tables& tables, std::uint32_t sum[4], AlphaSlopes& alpha) {
  constexpr auto slope_s = float(1 << slope_s_bits);
  const AxisSlopes tested_rows = is_tested ? axis_slopes(taps.down, slope_s) : AxisSlopes{};
  GB_UNROLL
  for (int j = 0; j < 3; ++j) {
    const std::uint32_t row = std::uint32_t(taps.down.texel[j]) * std::uint32_t(width);
    std::uint32_t at[3];
    for (int k = 0; k < 3; ++k) at[k] = row + std::uint32_t(taps.across.texel[k]);
    Rgba16 texel[3];
    load_texels<opaque, 3>(view, l, at, tables, texel);
    GB_UNROLL
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t weight = taps.weight(k, j);
      for (int c = 0; c < (opaque ? 3 : 4); ++c) sum[c] += weight * texel[k].c[c];
      if (!is_tested) continue;
      alpha.s += taps.columns.of[k] * taps.down.weight[j] * texel[k].c[3];
      alpha.t += tested_rows.of[j] * taps.across.weight[k] * texel[k].c[3];
    }
  }
}

/// Adds the mean of level l over a footprint around (s, t) to `total`.
template <bool opaque>
GB_HD void add_filtered_sample(const TextureView& view, const MaterialView& m, int l, const ImagePosition& s,
                               const ImagePosition& t, LevelFootprint footprint, const Tables& tables,
                               std::uint32_t total[4]) {
  const std::int32_t width = level_extent(view.width, l), height = level_extent(view.height, l);
  FootprintTaps taps;
  taps.across = axis_taps<weight_s_bits>(s.at, width, m.wrap_s, l == 0, footprint.width_squared);
  taps.down = axis_taps<weight_t_bits>(t.at, height, m.wrap_t, l == 0, footprint.height_squared);
  if (s.is_turned != t.is_turned) footprint.covariance = -footprint.covariance;
  constexpr auto slope_s = float(1 << slope_s_bits), slope_t = float(1 << slope_t_bits);
  taps.columns = axis_slopes(taps.across, slope_s);
  taps.rows = axis_slopes(taps.down, footprint.covariance * slope_t);
#if defined(GB_HAS_TEXEL_VECTOR)
  if (l > 0) return add_means<opaque>(sum_of_texels(view.level[l], width, taps), total);
#endif
  const bool is_tested = !opaque && l == 0 && view.mask_cutoff != 0;
  AlphaSlopes alpha{0, 0};
  std::uint32_t sum[4];
  for (std::uint32_t& x : sum) x = sum_start + sum_half;
  add_texels<opaque>(view, l, width, taps, is_tested, tables, sum, alpha);
#if defined(GB_HAS_TEXEL_VECTOR)
  if (!is_tested) return add_means<opaque>(TexelVector::load(sum), total);
#endif
  Rgba16 r{{0, 0, 0, 0}};
  for (int c = 0; c < (opaque ? 3 : 4); ++c) r.c[c] = channel_of(sum[c]);
  for (int c = 0; !opaque && c < 3; ++c) r.c[c] = smaller(r.c[c], r.c[3]);
  if (is_tested && r.c[3] != 0 && r.c[3] != 65535) r = test_footprint(r, view.mask_cutoff, alpha, footprint);
  for (int c = 0; c < 4; ++c) total[c] += r.c[c];
}

}  // namespace gigabake::kernels
