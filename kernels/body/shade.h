/// What a texture looks like on a fragment: linear, premultiplied 16-bit RGBA, averaged over the fragment.
///
/// Vertex colours are linear over a triangle, so their value at the fragment's centroid is their exact mean. Of a
/// texture a footprint is averaged that has the centroid and the second moments of the fragment's own polygon: so what
/// a parabola describes has its exact mean, and the fragments of a voxel add up to the same however its surface is cut
/// into triangles. It is read from the prefiltered pyramid at a level where three texels along each axis stand for it;
/// a wide one in up to nine parts.
///
/// Exact   Texel weights and sums are integers; positions are IEEE double, second moments IEEE float: host and device
///         agree.
/// Source  Heckbert 1989 (footprints from the Jacobian); Barkans 1997 (probes along the major axis).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "kernels/body/coverage.h"
#include "kernels/body/filter_texture.h"
#include "kernels/body/sample_texture.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// Texture coordinates as an affine function of a triangle's (u, v).
struct TextureMap {
  double s0, su, sv, t0, tu, tv;  ///< s = s0 + su·u + sv·v
  float xu, xv, yu, yv;           ///< the same gradients in texels
};

/// A gradient whose square is a float, too.
GB_HD float texels_of(double gradient) {
  constexpr double beyond_any_image = 1 << 30;
  return float(gradient < -beyond_any_image ? -beyond_any_image : at_most(gradient, beyond_any_image));
}

/// uv: 3 × (s, t). Range: finite, |s|, |t| ≤ 2^20 (checked by the caller).
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

/// Of a fragment's points on its texture.
GB_HD Spread texel_spread(const TextureMap& m, float uu, float uv, float vv) {
  const float xu = m.xu * uu + m.xv * uv, xv = m.xu * uv + m.xv * vv, yu = m.yu * uu + m.yv * uv,
              yv = m.yu * uv + m.yv * vv;
  return {m.xu * xu + m.xv * xv, m.yu * xu + m.yv * xv, m.yu * yu + m.yv * yv};
}

/// How much narrower a box around `middle` of a cell has to be, so that it reaches little beyond the cell. What has the
/// spread of half a cell reaches a quarter farther than to its border: beside a chart of an atlas that is too far, and
/// to end there takes too much from the spread. The variance of what is convex is at most half the square of how far
/// its middle is from the border, so `least` is for rounding alone.
GB_HD float share_within_cell(double middle, float variance) {
  constexpr float beyond = 1.1f, least = 0.875f;
  const float reach = beyond * float(smaller(middle, 1 - middle));
  return larger(least, smaller(1.0f, reach * inverse_root(3 * variance)));
}

/// What a wide footprint takes for the spread of its fragment.
GB_HD Spread spread_within_cell(const TextureMap& m, const FragmentShape& f) {
  const float u = share_within_cell(f.centroid.u - f.cell_u, f.uu),
              v = share_within_cell(f.centroid.v - f.cell_v, f.vv);
  return texel_spread(m, f.uu * (u * u), f.uv * (u * v), f.vv * (v * v));
}

/// How a footprint is read: parts in rows and columns, each with the spread `part` (texels of level 0), on one level.
/// Steps (images) lead to a row's next part, along the longer axis, and across to the next row.
struct FootprintParts {
  Spread part;
  float along_s, along_t, across_s, across_t;
  std::int32_t columns, rows, level;
  std::uint32_t reciprocal;  ///< of the parts, in 2^-31, rounded up
};

/// The finest level on which a box with the square of its edge, in texels of level 0, is no wider than the widest.
GB_HD int level_of(std::int32_t levels, float width_squared) {
  const float ratio = (width_squared + 3) * (1 / (widest_squared + 3));
  std::int32_t bits;  // exponent, then fraction
  std::memcpy(&bits, &ratio, sizeof bits);
  constexpr std::int32_t one = 0x3f800000;
  return bits > one ? smaller((((bits - one) >> 23) + 2) >> 1, levels - 1) : 0;
}

/// The square of the widest box that is read whole: nine texels have a box's shape as far as that, and its moments up
/// to `widest_squared`.
inline constexpr float widest_whole = 4.2f;

/// Parts of a box whose edge has the square `squared`, side by side, each about as long as the root of `wanted`.
GB_HD std::int32_t parts_along(float squared, float wanted) {
  constexpr std::int32_t most = 4;
  const float ratio = squared / wanted;
  return ratio < most * most ? std::int32_t(std::sqrt(ratio) + 0.5f) : most;
}

/// A box on a texture, slanted: along an axis of the texture its edge goes `slant` along the other one, too. Squares of
/// its parts' edges, and how many of them it has along each.
struct SlantedBox {
  float long_squared, short_squared, slant;
  std::int32_t columns, rows;
};

/// What is tested has one row of parts. Else what is wide along both axes has two, so that a finer level is read, or
/// three where that is the image itself.
GB_HD SlantedBox slanted_box(float longer, float covariance, float shorter, bool is_tested) {
  SlantedBox r;
  r.slant = covariance / longer;
  r.long_squared = 12 * longer;
  r.short_squared = 12 * larger(0.0f, shorter - covariance * r.slant);
  const float wholes = is_tested ? 0 : r.short_squared * (1 / widest_whole);
  r.rows = wholes <= 1 ? 1 : (wholes > 4 && wholes <= 9 ? 3 : 2);
  r.short_squared /= float(r.rows * r.rows);
  const std::int32_t along = parts_along(r.long_squared, larger(r.short_squared, 0.5f * widest_whole));
  r.columns = r.rows == 3 ? 3 : larger(along, is_tested ? 1 : 2);
  r.long_squared /= float(r.columns * r.columns);
  return r;
}

/// is_tested: by alpha. Then texels are taken of which a level says how many pass.
GB_HD_ONE_COPY FootprintParts wide_footprint(Spread all, std::int32_t width, std::int32_t height, std::int32_t levels,
                                             bool is_tested) {
  const bool along_s = 1.01f * all.ss >= all.tt;  // not by rounding where both are the same
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
  if (12 * larger(spread.ss, spread.tt) <= widest_whole) return {spread, 0, 0, 0, 0, 1, 1, 0, 0x80000001u};
  return wide_footprint(spread_within_cell(m, f), view.width, view.height, view.levels, view.mask_cutoff != 0);
}

/// 4^-level.
GB_HD float level_scale(int level) {
  const std::int32_t bits = (127 - 2 * level) << 23;
  float scale;
  std::memcpy(&scale, &bits, sizeof scale);
  return scale;
}

/// Of a footprint narrower than its level's texels, as it is counted: to sharpen more would make waves.
inline constexpr float narrowest_squared = -1.2f;

/// A footprint on its level, whose texels are boxes themselves; an image's own are what is asked for.
GB_HD LevelFootprint level_footprint(const FootprintParts& parts) {
  const float scale = level_scale(parts.level), own = 3 - 3 * scale;
  const float narrowest = parts.level == 0 ? 0 : narrowest_squared;
  LevelFootprint r{larger(12 * parts.part.ss * scale - own, narrowest),
                   larger(12 * parts.part.tt * scale - own, narrowest), 0};
  const float limit = larger(0.0f, smaller(r.width_squared + r.height_squared, 2 * widest_squared)) * (1.0f / 24);
  r.covariance = larger(-limit, smaller(parts.part.st * scale, limit));
  return r;
}

/// Whether a footprint around s reaches across an edge beyond which the outermost texels go on: those of a coarser
/// level hold more than them.
GB_HD bool is_across_edge(double s, Wrap wrap, std::int32_t size, float variance) {
  if (wrap != Wrap::clamp_to_edge) return false;
  const float inside = float(0.5 - std::fabs(s - 0.5)) * float(size);
  return inside < 0 || inside * inside < 3 * variance;
}

/// Mean of the texture over a fragment. opaque: for materials whose alpha is ignored; the result has none.
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
    const ImagePlace at_s = image_place(s + double(column * parts.along_s + row * parts.across_s), m.wrap_s),
                     at_t = image_place(t + double(column * parts.along_t + row * parts.across_t), m.wrap_t);
    const Rgba16 p = filtered_sample<opaque>(view, m, parts.level, at_s, at_t, footprint, tables);
    for (int c = 0; c < 4; ++c) sum[c] += p.c[c];
    row += column < last_column ? 0 : 1.0f;
    column = column < last_column ? column + 1 : first_column;
  }
  // Sums are below 2^20 and there are at most 9 parts: quotients are exact.
  Rgba16 r;
  for (int c = 0; c < 4; ++c)
    r.c[c] = std::uint16_t(std::uint64_t(sum[c] + std::uint32_t(count) / 2) * parts.reciprocal >> 31);
  return r;
}

}  // namespace gigabake::kernels
