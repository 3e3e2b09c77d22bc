/// The mean of a level of a texture over a small footprint on it, as bilinear interpolation has it.
///
/// Between the middles of four texels a texture is bilinear, so its mean over a box along its axes is a sum of the
/// texels that the box reaches, and a texel's weight is a product of one along each axis. Where a footprint is slanted,
/// the covariance of its two coordinates moves weight between diagonals: by the product of the weights' slopes, that is
/// how they change where the box moves. So texels weigh what the footprint's mean and second moments ask for.
///
/// Space   One level: texels, the first one's middle at 0.
/// Exact   Weights are integers that sum up to 2^24, made of IEEE floats: host and device agree, and one colour stays
///         that colour.
/// Range   Boxes of up to `widest_box` texels.
/// Cost    (w + 1)(h + 1) to (w + 2)(h + 2) texels for a box of w x h.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "kernels/body/brick_triangle.h"
#include "kernels/body/sample_texture.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

inline constexpr float widest_box = 3.99f, narrowest_box = 1.0f / 64;
inline constexpr int most_weighed = 6;  ///< texels along an axis
inline constexpr int axis_weight_bits = 12;

/// A box's extent along one axis, from the middle of the first of the texels that it weighs.
struct AxisBox {
  std::int32_t first;
  int count;
  float low, high;
  float scale;  ///< all of the weights, by the box's width
};

/// middle: in 2^-32 texels from the middle of texel 0.
GB_HD AxisBox axis_box(std::int64_t middle, float width) {
  constexpr int below = 4;
  const float from_texel = float(std::int32_t(std::uint32_t(middle) >> 8)) * (1.0f / (1 << 24));
  const float low = from_texel - 0.5f * width;
  const std::int32_t down = std::int32_t(low + below) - below;
  AxisBox r;
  r.first = std::int32_t(middle >> 32) + down;
  r.low = low - float(down);
  r.high = r.low + width;
  r.count = smaller(int(r.high) + 2, most_weighed);
  r.scale = float(1 << axis_weight_bits) / width;
  return r;
}

/// What texels weigh, and minus how much their weights grow where the box moves on by a texel.
struct AxisWeight {
  std::int32_t weight, slope;
};

/// The whole number that is nearest: by what a float of 2^23 has left for fractions, which a device does at once.
/// Range  0 ≤ x ≤ 2^22.
GB_HD std::int32_t rounded(float x) {
  const float whole = x + 12582912.0f;  // 1.5 · 2^23
  std::int32_t bits;
  std::memcpy(&bits, &whole, sizeof bits);
  return bits - 0x4b400000;
}

/// Of all texels up to number k: sums, so that their differences' sum is exact whatever is rounded.
GB_HD AxisWeight weights_up_to(const AxisBox& b, int k) {
  const float high = smaller(b.high - float(k), 1.0f), low = smaller(b.low - float(k), 1.0f);
  const float h = larger(high, 0.0f), l = larger(low, 0.0f);
  return {rounded(((high - 0.5f * h * h) - (low - 0.5f * l * l)) * b.scale), rounded((h - l) * b.scale)};
}

/// Box and covariance (texels and texels²) that stand for a footprint on one level.
struct LevelFootprint {
  float width, height, covariance;
};

/// Texel i of the endless row that an image of `size` texels wraps to; near the image, which most rows never leave.
GB_HD std::int32_t texel_near(std::int32_t i, std::int32_t size, Wrap wrap) {
  while (std::uint32_t(i) >= std::uint32_t(size)) {
    if (wrap == Wrap::clamp_to_edge) return i < 0 ? 0 : size - 1;
    if (wrap == Wrap::repeat)
      i += i < 0 ? size : -size;
    else
      i = i < 0 ? -1 - i : 2 * size - 1 - i;
  }
  return i;
}

/// Rounded, from a sum of texels by weights. What a covariance takes from a texel may lead below black or above white.
GB_HD std::uint16_t channel_of(std::int64_t sum) {
  constexpr int bits = 2 * axis_weight_bits;
  const auto mean = std::int32_t((sum + (std::int64_t(1) << (bits - 1))) >> bits);
  return std::uint16_t(mean < 0 ? 0 : smaller(mean, 65535));
}

/// Where a sample lies on an image.
struct ImagePlace {
  std::int64_t at;  ///< 2^-32 of the image
  bool is_turned;   ///< whether the image is mirrored there
};

/// Where it is clamped, places are kept up to half an image beyond the edge: a footprint may lie on both sides.
GB_HD ImagePlace image_place(double s, Wrap wrap) {
  if (wrap != Wrap::clamp_to_edge) {
    const bool is_turned = wrap == Wrap::mirrored_repeat && low_word(s + 3145728.0) >> 31 != 0;
    return {std::int64_t(fraction_of(s, wrap)), is_turned};
  }
  const double from_middle = s - 0.5, within = from_middle < -1 ? -1 : (from_middle > 0.999 ? 0.999 : from_middle);
  return {(std::int64_t(std::int32_t(low_word(within + 3145728.0))) + (std::int64_t(1) << 30)) * 2, false};
}

/// A sample's place on one level.
struct LevelPlace {
  std::int32_t width, height;
  std::int64_t x, y;  ///< 2^-32 texels from the middle of texel 0
};

GB_HD LevelPlace level_place(const TextureView& view, int l, const ImagePlace& s, const ImagePlace& t) {
  constexpr std::int64_t half = std::int64_t(1) << 31;
  const std::int32_t width = level_extent(view.width, l), height = level_extent(view.height, l);
  return {width, height, s.at * width - half, t.at * height - half};
}

/// A box's texels along s and their weights.
struct Columns {
  std::int32_t first, last;
  std::int32_t of[most_weighed];  ///< weight above, slope below 2^16: half as many registers
};

GB_HD Columns weighed_columns(const AxisBox& box) {
  Columns r{box.first, box.first + box.count - 1, {}};
  AxisWeight before{0, 0};
  GB_UNROLL
  for (int i = 0; i < most_weighed; ++i) {
    if (i == 4 && box.count <= 4) break;
    const AxisWeight now = weights_up_to(box, smaller(i, box.count - 1));
    r.of[i] = (now.weight - before.weight) * 65536 | ((now.slope - before.slope) & 65535);
    before = now;
  }
  return r;
}

/// Four texels of a row. Those beyond the last column are that one once more.
template <int first>
GB_HD void place_texels(const Columns& columns, std::uint32_t row, std::int32_t width, Wrap wrap, std::uint32_t at[4]) {
  const bool is_inside = columns.first >= 0 && columns.last < width;
  GB_UNROLL
  for (int k = 0; k < 4; ++k) at[k] = std::uint32_t(smaller(columns.first + first + k, columns.last));
  if (!is_inside)
    for (int k = 0; k < 4; ++k) at[k] = std::uint32_t(texel_near(std::int32_t(at[k]), width, wrap));
  GB_UNROLL
  for (int k = 0; k < 4; ++k) at[k] += row;
}

/// Sums of weighed texels: colours and alpha, and how much alpha's mean falls where the box moves on along s and t.
template <bool opaque>
struct TexelSums {
  std::int64_t of[opaque ? 3 : 4] = {};
  std::int64_t slope_s = 0, slope_t = 0;  ///< not of opaque ones
};

template <bool opaque, int first>
GB_HD void add_texels(const TextureView& view, int l, const std::uint32_t at[4], const Columns& columns,
                      const AxisWeight& of_row, std::int32_t covariance, const Tables& tables, TexelSums<opaque>& sum) {
  Rgba16 texel[4];
  load_texels<opaque>(view, l, at, tables, texel);
  GB_UNROLL
  for (int k = 0; k < 4 && first + k < most_weighed; ++k) {
    const std::int32_t both = columns.of[first + k];
    const std::int32_t weight = both >> 16, slope = std::int16_t(both & 65535);
    const std::int32_t w = weight * of_row.weight + slope * (of_row.slope * covariance >> axis_weight_bits);
    for (int c = 0; c < (opaque ? 3 : 4); ++c) sum.of[c] += std::int64_t(w) * std::int32_t(texel[k].c[c]);
    if constexpr (!opaque) {
      sum.slope_s += std::int64_t(slope * of_row.weight) * std::int32_t(texel[k].c[3]);
      sum.slope_t += std::int64_t(weight * of_row.slope) * std::int32_t(texel[k].c[3]);
    }
  }
}

GB_HD float half_square(float x) { return x > 0 ? 0.5f * x * x : 0; }

/// Of a box over which alpha is a plane, `beyond` the cutoff in its middle, and changes by `along` one edge and
/// `across` the other: the share that passes.
GB_HD float passing_share(float beyond, float along, float across) {
  const float longer = larger(larger(along, across), 1.0f), shorter = larger(smaller(along, across), longer / 64);
  const float far = 0.5f * (longer + shorter), near = 0.5f * (longer - shorter);
  const float share = ((half_square(beyond + far) - half_square(beyond + near)) -
                       (half_square(beyond - near) - half_square(beyond - far))) /
                      (longer * shorter);
  return larger(0.0f, smaller(share, 1.0f));
}

/// An alpha test of what is interpolated, as a renderer makes it point by point: of a box, with alpha's mean and
/// slopes, so much passes as of a plane.
GB_HD Rgba16 test_box(const Rgba16& mean, std::uint8_t cutoff, float along, float across) {
  if (mean.c[3] == 0) return mean;
  const float share = passing_share(float(int(mean.c[3]) - int(cutoff * 257u)), along, across);
  const auto alpha = std::uint32_t(rounded(share * 65535));
  Rgba16 r;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t straight = (mean.c[c] * 65535u + mean.c[3] / 2u) / mean.c[3];
    r.c[c] = scale16(smaller(straight, 65535u), alpha);
  }
  r.c[3] = std::uint16_t(alpha);
  return r;
}

/// Mean of level l over a footprint around (s, t).
template <bool opaque>
GB_HD Rgba16 filtered_sample(const TextureView& view, const MaterialView& m, int l, const LevelPlace& place,
                             const LevelFootprint& footprint, const Tables& tables) {
  const AxisBox box = axis_box(place.x, footprint.width), rows = axis_box(place.y, footprint.height);
  const std::int32_t covariance = std::int32_t(footprint.covariance * float(1 << axis_weight_bits));
  const Columns columns = weighed_columns(box);
  TexelSums<opaque> sum;
  AxisWeight before{0, 0};
  GB_NO_UNROLL
  for (int j = 0; j < rows.count; ++j) {
    const AxisWeight now = weights_up_to(rows, j);
    const AxisWeight of_row{now.weight - before.weight, now.slope - before.slope};
    before = now;
    const std::uint32_t row =
        std::uint32_t(texel_near(rows.first + j, place.height, m.wrap_t)) * std::uint32_t(place.width);
    std::uint32_t at[4];
    place_texels<0>(columns, row, place.width, m.wrap_s, at);
    add_texels<opaque, 0>(view, l, at, columns, of_row, covariance, tables, sum);
    if (box.count <= 4) continue;
    place_texels<4>(columns, row, place.width, m.wrap_s, at);
    add_texels<opaque, 4>(view, l, at, columns, of_row, covariance, tables, sum);
  }
  Rgba16 r{{0, 0, 0, 0}};
  for (int c = 0; c < (opaque ? 3 : 4); ++c) r.c[c] = channel_of(sum.of[c]);
  if constexpr (!opaque) {
    for (int c = 0; c < 3; ++c) r.c[c] = smaller(r.c[c], r.c[3]);
    if (l == 0 && view.mask_cutoff != 0) {
      constexpr float one = float(1 << 2 * axis_weight_bits);
      return test_box(r, view.mask_cutoff, std::fabs(float(sum.slope_s)) * (footprint.width / one),
                      std::fabs(float(sum.slope_t)) * (footprint.height / one));
    }
  }
  return r;
}

}  // namespace gigabake::kernels
