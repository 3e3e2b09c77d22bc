/// Mean of a texture over a fragment: linear, premultiplied 16-bit RGBA.
///
/// Vertex colours are linear over a triangle, so their value at the fragment's centroid is their exact mean. A texture
/// is averaged over a footprint with the centroid and second moments of the fragment's polygon. A quadratic texture
/// therefore has its exact mean. The fragments of a voxel sum to the same result for any division of its surface into
/// triangles. The footprint is read from the prefiltered pyramid at a level where three texels along each axis
/// represent it. A wide footprint is read in up to nine parts.
///
/// Exact   Texel weights and sums are integers; positions are IEEE double, second moments IEEE float: host and device
///         agree.
/// Source  Heckbert 1989 (footprints from the Jacobian); Barkans 1997 (probes along the major axis).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/base/host_device.h"
#include "kernels/body/texture/filter_texture.h"
#include "kernels/body/texture/sample_texture.h"
#include "kernels/body/voxelize/coverage.h"

namespace gigabake::kernels {

/// Texture coordinates as an affine function of a triangle's (u, v).
struct TextureMap {
  double s0, su, sv, t0, tu, tv;  ///< s = s0 + su·u + sv·v
  float xu, xv, yu, yv;           ///< the same gradients in texels
};

/// Returns the gradient as float, clamped so that its square is also finite.
GB_HD float texels_of(double gradient) {
  constexpr double beyond_any_image = 1 << 30;
  return float(gradient < -beyond_any_image ? -beyond_any_image : at_most(gradient, beyond_any_image));
}

/// Returns the map from a triangle's plane to its texture. `uv` holds (s, t) of the three vertices.
/// Range   Finite; |s|, |t| ≤ 2^20 (checked by the caller).
GB_HD TextureMap make_texture_map(const TrianglePlane& p, const float uv[6], std::int32_t width, std::int32_t height) {
  TextureMap r;
  const double u1 = p.u[1] - p.u[0], v1 = p.v[1] - p.v[0], u2 = p.u[2] - p.u[0], v2 = p.v[2] - p.v[0];
  const double inverse = p.inverse_twice_area;
  const double s1 = double(uv[2]) - uv[0], s2 = double(uv[4]) - uv[0], t1 = double(uv[3]) - uv[1],
               t2 = double(uv[5]) - uv[1];
  r.su = (s1 * v2 - s2 * v1) * inverse;
  r.sv = (s2 * u1 - s1 * u2) * inverse;
  r.tu = (t1 * v2 - t2 * v1) * inverse;
  r.tv = (t2 * u1 - t1 * u2) * inverse;
  r.s0 = uv[0] - (r.su * p.u[0] + r.sv * p.v[0]);
  r.t0 = uv[1] - (r.tu * p.u[0] + r.tv * p.v[0]);
  r.xu = texels_of(r.su * width);
  r.xv = texels_of(r.sv * width);
  r.yu = texels_of(r.tu * height);
  r.yv = texels_of(r.tv * height);
  return r;
}

/// Variances and covariance of points, voxels² or texels².
struct Spread {
  float ss, st, tt;
};

/// Returns the variances and covariance of a fragment's points on its texture.
GB_HD Spread texel_spread(const TextureMap& m, float uu, float uv, float vv) {
  const float xu = m.xu * uu + m.xv * uv, xv = m.xu * uv + m.xv * vv, yu = m.yu * uu + m.yv * uv,
              yv = m.yu * uv + m.yv * vv;
  return {m.xu * xu + m.xv * xv, m.yu * xu + m.yv * xv, m.yu * yu + m.yv * yv};
}

/// Returns the factor, at least 0.875, by which a filter box centred at `middle` (0 to 1) of a cell is narrowed. The
/// box then extends beyond the cell by at most 10 % of the distance from its centre to the border. Without narrowing,
/// the box has the variance of its fragment. For a triangle that covers half the cell, it would extend beyond the cell
/// by a quarter of that distance. It would then cover texels outside an atlas chart. If it ended at the border, it
/// would lose too much variance. `minimum` only guards against rounding. The variance of a convex shape is at most half
/// the square of the distance from its centre to the border.
GB_HD float narrowing_factor(double middle, float variance) {
  constexpr float beyond = 1.1f, minimum = 0.875f;
  const float reach = beyond * float(smaller(middle, 1 - middle));
  return larger(minimum, smaller(1.0f, reach * inverse_root(3 * variance)));
}

/// Returns the spread of a wide footprint, narrowed by narrowing_factor().
GB_HD Spread spread_within_cell(const TextureMap& m, const FragmentShape& f) {
  const float u = narrowing_factor(f.centroid.u - f.cell_u, f.uu), v = narrowing_factor(f.centroid.v - f.cell_v, f.vv);
  return texel_spread(m, f.uu * (u * u), f.uv * (u * v), f.vv * (v * v));
}

/// Parts of a footprint, in rows along its longer axis. All parts are read from one level and have the spread `part`,
/// in texels² of level 0. The step (along_s, along_t) leads to the next part of a row, and (across_s, across_t) to the
/// next row. Steps are fractions of the image.
struct FootprintParts {
  Spread part;
  float along_s, along_t, across_s, across_t;
  std::int32_t columns, rows, level;
  std::uint32_t reciprocal;  ///< 2^31 / number of parts, rounded up
};

/// Returns the finest level on which a box has a squared edge of at most `max_width_squared` texels². `width_squared`
/// is the box's squared edge in texels² of level 0.
GB_HD int level_of(std::int32_t levels, float width_squared) {
  const float ratio = (width_squared + 3) * (1 / (max_width_squared + 3));
  std::int32_t bits;  // exponent, then fraction
  std::memcpy(&bits, &ratio, sizeof bits);
  constexpr std::int32_t one = 0x3f800000;
  return bits > one ? smaller((((bits - one) >> 23) + 2) >> 1, levels - 1) : 0;
}

/// Squared edge of the widest box that is read as a whole. Nine texels reproduce a box's shape up to this width, and
/// its moments up to `max_width_squared`.
inline constexpr float max_whole_squared = 4.2f;

/// Returns the number of adjacent parts of a box with squared edge `squared`, each about as long as the root of
/// `wanted`; at most four.
GB_HD std::int32_t parts_along(float squared, float wanted) {
  constexpr std::int32_t maximum = 4;
  const float ratio = squared / wanted;
  return ratio < maximum * maximum ? std::int32_t(std::sqrt(ratio) + 0.5f) : maximum;
}

/// Slanted box on a texture. Per texel along the box's longer axis, its edge moves by `slant` texels along the other
/// axis. The box has columns · rows parts; `long_squared` and `short_squared` are the squared edges of a part.
struct SlantedBox {
  float long_squared, short_squared, slant;
  std::int32_t columns, rows;
};

/// Divides a footprint into parts. A footprint with an alpha test has one row. Other footprints that are wide along
/// both axes have two rows, so that a finer level is read. They have three rows if that level is the image itself.
GB_HD SlantedBox slanted_box(float longer, float covariance, float shorter, bool is_tested) {
  SlantedBox r;
  r.slant = covariance / longer;
  r.long_squared = 12 * longer;
  r.short_squared = 12 * larger(0.0f, shorter - covariance * r.slant);
  const float wholes = is_tested ? 0 : r.short_squared * (1 / max_whole_squared);
  r.rows = wholes <= 1 ? 1 : (wholes > 4 && wholes <= 9 ? 3 : 2);
  r.short_squared /= float(r.rows * r.rows);
  const std::int32_t along = parts_along(r.long_squared, larger(r.short_squared, 0.5f * max_whole_squared));
  r.columns = r.rows == 3 ? 3 : larger(along, is_tested ? 1 : 2);
  r.long_squared /= float(r.columns * r.columns);
  return r;
}

/// Returns the parts of a wide footprint. If `is_tested`, the texture has an alpha test. A level ≥ 1 is then read,
/// because its alpha is the fraction of texels that pass.
GB_HD_NOINLINE FootprintParts wide_footprint(Spread all, std::int32_t width, std::int32_t height, std::int32_t levels,
                                             bool is_tested) {
  const bool along_s = 1.01f * all.ss >= all.tt;  // if both are equal, rounding must not decide
  const SlantedBox box = slanted_box(along_s ? all.ss : all.tt, all.st, along_s ? all.tt : all.ss, is_tested);
  const float step = std::sqrt(box.long_squared), row_step = std::sqrt(box.short_squared), slanted = step * box.slant;
  const float longer = box.long_squared * (1.0f / 12), covariance = longer * box.slant,
              shorter = covariance * box.slant + box.short_squared * (1.0f / 12);
  FootprintParts r;
  r.part = along_s ? Spread{longer, covariance, shorter} : Spread{shorter, covariance, longer};
  r.along_s = (along_s ? step : slanted) / float(width);
  r.along_t = (along_s ? slanted : step) / float(height);
  r.across_s = (along_s ? 0 : row_step) / float(width);
  r.across_t = (along_s ? row_step : 0) / float(height);
  r.columns = box.columns;
  r.rows = box.rows;
  r.level = smaller(larger(level_of(levels, 12 * larger(longer, shorter)), is_tested ? 1 : 0), levels - 1);
  r.reciprocal = 0x80000000u / std::uint32_t(r.columns * r.rows) + 1;
  return r;
}

GB_HD FootprintParts footprint_parts(const TextureView& view, const TextureMap& m, const FragmentShape& f) {
  const Spread spread = texel_spread(m, f.uu, f.uv, f.vv);
  if (12 * larger(spread.ss, spread.tt) <= max_whole_squared) return {spread, 0, 0, 0, 0, 1, 1, 0, 0x80000001u};
  return wide_footprint(spread_within_cell(m, f), view.width, view.height, view.levels, view.mask_cutoff != 0);
}

/// Returns 4^-level.
GB_HD float level_scale(int level) {
  const std::int32_t bits = (127 - 2 * level) << 23;
  float scale;
  std::memcpy(&scale, &bits, sizeof scale);
  return scale;
}

/// Min squared width of a footprint relative to its level's texels. A lower value would sharpen more and cause ringing.
inline constexpr float min_width_squared = -1.2f;

/// Returns a footprint on its level. Texels of coarser levels are boxes themselves, and their width is subtracted. At
/// level 0 nothing is subtracted.
GB_HD LevelFootprint level_footprint(const FootprintParts& parts) {
  const float scale = level_scale(parts.level), own = 3 - 3 * scale;
  const float minimum = parts.level == 0 ? 0 : min_width_squared;
  LevelFootprint r{larger(12 * parts.part.ss * scale - own, minimum), larger(12 * parts.part.tt * scale - own, minimum),
                   0};
  const float limit = larger(0.0f, smaller(r.width_squared + r.height_squared, 2 * max_width_squared)) * (1.0f / 24);
  r.covariance = larger(-limit, smaller(parts.part.st * scale, limit));
  return r;
}

/// Returns true if a footprint around s crosses an edge of a clamped texture. Beyond the edge, the image's outermost
/// texels continue. Texels of a coarser level do not suit it, because they also average texels farther inside.
GB_HD bool is_across_edge(double s, Wrap wrap, std::int32_t size, float variance) {
  if (wrap != Wrap::clamp_to_edge) return false;
  const float inside = float(0.5 - std::fabs(s - 0.5)) * float(size);
  return inside < 0 || inside * inside < 3 * variance;
}

/// Returns the mean of the texture over a fragment. If `opaque`, the material ignores alpha and the result has no
/// alpha.
template <bool opaque>
GB_HD Rgba16 texture_over(const TextureView& view, const MaterialView& m, const TextureMap& map, const FragmentShape& f,
                          const Tables& tables) {
  FootprintParts parts = footprint_parts(view, map, f);
  const double s = (map.s0 + map.su * f.centroid.u) + map.sv * f.centroid.v,
               t = (map.t0 + map.tu * f.centroid.u) + map.tv * f.centroid.v;
  if (parts.level > (view.mask_cutoff != 0 ? 1 : 0) && (is_across_edge(s, m.wrap_s, view.width, parts.part.ss) ||
                                                        is_across_edge(t, m.wrap_t, view.height, parts.part.tt)))
    --parts.level;
  const LevelFootprint footprint = level_footprint(parts);
  std::uint32_t sum[4] = {0, 0, 0, 0};
  const std::int32_t count = parts.columns * parts.rows;
  const float first_column = -0.5f * float(parts.columns - 1), last_column = -first_column;
  float column = first_column, row = -0.5f * float(parts.rows - 1);
  GB_NO_UNROLL
  for (std::int32_t i = 0; i < count; ++i) {
    const ImagePosition at_s = image_position(s + double(column * parts.along_s + row * parts.across_s), m.wrap_s),
                        at_t = image_position(t + double(column * parts.along_t + row * parts.across_t), m.wrap_t);
    add_filtered_sample<opaque>(view, m, parts.level, at_s, at_t, footprint, tables, sum);
    row += column < last_column ? 0 : 1.0f;
    column = column < last_column ? column + 1 : first_column;
  }
  // Sums are below 2^20 and there are at most 9 parts, so the quotients are exact.
  Rgba16 r;
  for (int c = 0; c < 4; ++c)
    r.c[c] = std::uint16_t(std::uint64_t(sum[c] + std::uint32_t(count) / 2) * parts.reciprocal >> 31);
  return r;
}

}  // namespace gigabake::kernels
