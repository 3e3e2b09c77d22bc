/// Mean of a texture over a fragment if its sampler picks the nearest texel. Each texel is weighted by its area inside
/// the fragment.
///
/// A texel is a square of one colour. If a fragment covers many texels, texels of a coarser level are used, also as
/// squares.
///
/// Space   Texels of one level, relative to the first texel that the fragment may overlap.
/// Exact   IEEE double without contraction, then integers: host and device agree. A fragment over few texels (about 7 x
///         7) gets their exact mean, with weights rounded to 2^-24. A larger fragment uses coarser texels. Along its
///         border, these texels also average texels outside the fragment, and this is the error. A texture of one
///         colour keeps exactly that colour.
/// Range   |s|, |t| ≤ 2^20. Only gradients of degenerate slivers produce larger values; the texel that is picked is
///         then arbitrary.
/// Cost    At most 130 texels per fragment, each tested against two to nine edges.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/math/rounding.h"
#include "kernels/body/texture/material.h"
#include "kernels/body/texture/sample_texture.h"
#include "kernels/body/texture/shade.h"
#include "kernels/body/texture/texture_view.h"
#include "kernels/body/voxelize/coverage.h"

namespace gigabake::kernels {

/// Polygon of a fragment, in voxels from its cell's lowest corner. It is the triangle, cut to a slab of voxels
/// (cut_slab()) and then to the cell. The first cut leaves at most five corners; each side of the cell adds at most
/// one.
struct Outline {
  static constexpr int maximum = 9;
  Point2 at[maximum];
  int count;

  GB_HD void add(Point2 p) {
    if (count < maximum) at[count++] = p;  // rounding may make a sliver non-convex, which adds corners
  }
};

/// Returns the signed distance of a point from one of the four sides of the unit cell, positive inside.
GB_HD double depth_in_cell(Point2 p, int side) {
  const double x = side < 2 ? p.u : p.v;
  return (side & 1) == 0 ? x : 1 - x;
}

GB_HD Outline cut_by_side(const Outline& from, int side) {
  Outline r;
  r.count = 0;
  for (int i = 0; i < from.count; ++i) {
    const Point2 a = from.at[i], b = from.at[i + 1 == from.count ? 0 : i + 1];
    const double da = depth_in_cell(a, side), db = depth_in_cell(b, side);
    if (da >= 0) r.add(a);
    if ((da < 0) == (db < 0)) continue;
    const double t = da / (da - db);
    r.add({a.u + (b.u - a.u) * t, a.v + (b.v - a.v) * t});
  }
  return r;
}

GB_HD Outline outline_of(const FragmentShape& f) {
  Outline r;
  r.count = 0;
  for (int i = 0; i < f.corners; ++i) r.add({f.polygon_u[i] - f.cell_u, f.polygon_v[i] - f.cell_v});
  GB_NO_UNROLL
  for (int side = 0; side < 4; ++side) r = cut_by_side(r, side);
  return r;
}

/// Texture mapping of a fragment. It is passed by value, so that a caller that rarely calls nearest_over() can keep it
/// in registers.
struct NearestMap {
  double s0, su, sv, t0, tu, tv;  ///< as in TextureMap
  Wrap wrap_s, wrap_t;
};

GB_HD NearestMap nearest_map(const MaterialView& m, const TextureMap& map) {
  return {map.s0, map.su, map.sv, map.t0, map.tu, map.tv, m.wrap_s, m.wrap_t};
}

/// Maps s to the first period of the wrapped texture: one image, or a pair of images if mirrored.
GB_HD double in_first_period(double s, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return s;
  return wrap == Wrap::repeat ? s - std::floor(s) : s - 2 * std::floor(s * 0.5);
}

/// Returns the index in the image of texel i of the wrapped row. The image has `size` texels along the row.
/// Range   |i| < 2^30.
GB_HD std::int32_t wrapped_texel(std::int32_t i, std::int32_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return i < 0 ? 0 : smaller(i, size - 1);
  const std::int32_t period = wrap == Wrap::repeat ? size : 2 * size, rest = i % period,
                     at = rest < 0 ? rest + period : rest;
  return at < size ? at : period - 1 - at;
}

/// Max number of texels in a fragment's box. The finest level within this limit is used.
inline constexpr int max_texels_inside = 64;

/// Texels along one axis that a footprint may overlap.
struct TexelSpan {
  std::int32_t first, count;  ///< index of the first texel in the wrapped row, and number of texels
  double middle;              ///< position of the centroid from the first texel's lower border

  GB_HD std::int32_t middle_texel() const { return first + std::int32_t(at_most(middle, count - 0.5)); }
};

/// Returns the texels of a fragment that extends from middle + low to middle + high on the wrapped row. Far beyond a
/// clamped edge the first texel is moved closer, because all texels there are equal.
GB_HD TexelSpan texels_between(double middle, double low, double high, std::int32_t size) {
  constexpr double maximum = max_texels_inside + 2;
  const double first = std::floor(middle + low), count = std::ceil(middle + high) - first;
  const double near = first < -maximum ? -maximum : at_most(first, 2.0 * size);
  return {std::int32_t(near), std::int32_t(count < 1 ? 1 : at_most(count, maximum)), middle - first};
}

/// Returns one texel of the image, linear and premultiplied. If there is an alpha test, the texel is opaque or
/// transparent.
GB_HD Rgba16 base_texel(const std::uint8_t* rgba, std::uint8_t mask_cutoff, const std::uint16_t* linear_from_srgb) {
  std::uint8_t p[4];
  copy_texel<4>(rgba, p);
  const std::uint32_t alpha = mask_cutoff == 0 ? p[3] * 257u : (p[3] >= mask_cutoff ? 65535u : 0u);
  Rgba16 r;
  for (int c = 0; c < 3; ++c) r.c[c] = scale16(linear_from_srgb[p[c]], alpha);
  r.c[3] = std::uint16_t(alpha);
  return r;
}

/// One level of a texture with the sampler's wrap modes.
struct TexelGrid {
  const TextureView* view;
  std::int32_t level, width, height;
  Wrap wrap_s, wrap_t;
  const std::uint16_t* linear_from_srgb;

  /// Returns texel (x, y) of the wrapped plane.
  GB_HD Rgba16 texel(std::int32_t x, std::int32_t y) const {
    const std::size_t at =
        std::size_t(wrapped_texel(y, height, wrap_t)) * std::size_t(width) + wrapped_texel(x, width, wrap_s);
    if (level == 0) return base_texel(view->base + 4 * at, view->mask_cutoff, linear_from_srgb);
    Rgba16 r;
    copy_texel<8>(view->level[level] + 4 * at, r.c);
    return r;
  }
};

GB_HD TexelGrid texel_grid(const TextureView& view, int level, Wrap wrap_s, Wrap wrap_t,
                           const std::uint16_t* linear_from_srgb) {
  return {&view,  level,           level_extent(view.width, level), level_extent(view.height, level), wrap_s,
          wrap_t, linear_from_srgb};
}

/// Returns the texel of the image that contains (s, t), as a renderer picks it.
GB_HD Rgba16 nearest_texel(const TextureView& view, Wrap wrap_s, Wrap wrap_t, double s, double t,
                           const std::uint16_t* linear_from_srgb) {
  const TexelGrid grid = texel_grid(view, 0, wrap_s, wrap_t, linear_from_srgb);
  return grid.texel(texels_between(in_first_period(s, wrap_s) * grid.width, 0, 0, grid.width).first,
                    texels_between(in_first_period(t, wrap_t) * grid.height, 0, 0, grid.height).first);
}

/// Linear map from a fragment's (u, v) to (s, t). A degenerate map, for example of a colour ramp along a line, is
/// widened to a thousandth of its length. The mapped fragment then has an area.
struct FragmentMap {
  double su, sv, tu, tv, determinant;
};

GB_HD FragmentMap fragment_map(const NearestMap& look, double width, double height) {
  constexpr double minimum = 1.0 / 1024;
  double xu = look.su * width, xv = look.sv * width, yu = look.tu * height, yv = look.tv * height;
  const double along_u = xu * xu + yu * yu, along_v = xv * xv + yv * yv, longer = larger(along_u, along_v);
  const double determinant = xu * yv - xv * yu, across = determinant < 0 ? -minimum : minimum;
  if (std::fabs(determinant) < minimum * longer) {
    const bool moves_v = along_u >= along_v;
    const double dx = across * (moves_v ? -yu : yv), dy = across * (moves_v ? xu : -xv);
    (moves_v ? xv : xu) += dx;
    (moves_v ? yv : yu) += dy;
  }
  return {xu / width, xv / width, yu / height, yv / height, (xu * yv - xv * yu) / (width * height)};
}

/// Corners of a fragment on the texture. map_outline() writes them relative to the fragment's centroid, in images.
/// place_outline() converts them to texels from the first texel.
struct TexelOutline {
  double x[Outline::maximum], y[Outline::maximum];
  Line line[Outline::maximum];
  double low_x, high_x, low_y, high_y;
  int count;
};

/// Maps the outline to the texture and writes it to `r`. `r` is not a return value, because nvcc 13.0 would place the
/// returned corners at the address of `o`. The fifth corner of `o` would then be overwritten before it is read. The
/// error shows in the PTX and in the tests DeviceTextures.
GB_HD void map_outline(const Outline& o, const FragmentMap& map, Point2 centroid, TexelOutline& r) {
  r.low_x = r.high_x = r.low_y = r.high_y = 0;
  r.count = o.count;
  for (int i = 0; i < o.count; ++i) {
    const double du = o.at[i].u - centroid.u, dv = o.at[i].v - centroid.v;
    r.x[i] = map.su * du + map.sv * dv;
    r.y[i] = map.tu * du + map.tv * dv;
    r.low_x = smaller(r.low_x, r.x[i]);
    r.high_x = larger(r.high_x, r.x[i]);
    r.low_y = smaller(r.low_y, r.y[i]);
    r.high_y = larger(r.high_y, r.y[i]);
  }
}

/// Returns the finest level with at most max_texels_inside texels in the outline's box.
GB_HD int level_for(const TextureView& view, const TexelOutline& o) {
  const double across = o.high_x - o.low_x, down = o.high_y - o.low_y;
  int l = 0;
  while (l + 1 < view.levels &&
         (across * level_extent(view.width, l) + 1) * (down * level_extent(view.height, l) + 1) > max_texels_inside)
    ++l;
  return l;
}

/// Converts the outline's coordinates from images relative to the centroid to texels relative to the first texel. An
/// image has width × height texels, and (middle_x, middle_y) is the centroid.
GB_HD void place_outline(double width, double height, double middle_x, double middle_y, TexelOutline& o) {
  for (int i = 0; i < o.count; ++i) {
    o.x[i] = middle_x + o.x[i] * width;
    o.y[i] = middle_y + o.y[i] * height;
  }
  for (int i = 0; i < o.count; ++i) {
    const int j = i + 1 == o.count ? 0 : i + 1;
    o.line[i] = line_along(o.x[j] - o.x[i], o.y[j] - o.y[i]);
  }
}

/// Returns a mask: bit i is set if edge i passes through the row of texels.
GB_HD unsigned edges_in_row(const TexelOutline& o, double row) {
  unsigned edges = 0;
  for (int i = 0; i < o.count; ++i) {
    const double a = o.y[i], b = o.y[i + 1 == o.count ? 0 : i + 1];
    if (larger(a, b) > row && smaller(a, b) < row + 1 && a != b) edges |= 1u << i;
  }
  return edges;
}

/// Returns the covered area of a texel. Edges left of the texel add nothing. Edges right of it add the length in y of
/// their part in the row. Most edges are in one of these two cases, which are tested first.
GB_HD double covered_area(const TexelOutline& o, unsigned edges, double column, double row) {
  CellMoments sum{};
  for (int i = 0; i < o.count; ++i) {
    const int j = i + 1 == o.count ? 0 : i + 1;
    if ((edges >> i & 1) == 0 || larger(o.x[i], o.x[j]) <= column) continue;
    if (smaller(o.x[i], o.x[j]) >= column + 1)
      sum.area += clamp01(o.y[j] - row) - clamp01(o.y[i] - row);
    else
      add_edge<Moments::area>(o.x[i] - column, o.y[i] - row, o.y[j] - row, o.line[i], sum);
  }
  return sum.area;
}

/// Returns the mean of the covered texels. `weight_scale` is the weight per covered texel², with the sign of the
/// outline's orientation.
GB_HD Rgba16 mean_of_covered(const TexelGrid& grid, const TexelSpan& columns, const TexelSpan& rows,
                             const TexelOutline& o, double weight_scale) {
  constexpr double max_weight = 1 << 30;  // weights sum to 2^24, so only rounding could exceed this limit
  std::uint64_t sum[4] = {0, 0, 0, 0}, weights = 0;
  for (std::int32_t j = 0; j < rows.count; ++j) {
    const unsigned edges = edges_in_row(o, j);
    for (std::int32_t i = 0; i < columns.count; ++i) {
      const double wanted = at_most(covered_area(o, edges, i, j) * weight_scale, max_weight);
      if (wanted < 0.5) continue;
      const auto weight = std::uint64_t(floor_to_int64(wanted + 0.5));
      const Rgba16 texel = grid.texel(columns.first + i, rows.first + j);
      for (int c = 0; c < 4; ++c) sum[c] += weight * texel.c[c];
      weights += weight;
    }
  }
  if (weights == 0) return grid.texel(columns.middle_texel(), rows.middle_texel());
  Rgba16 r;
  for (int c = 0; c < 4; ++c) r.c[c] = std::uint16_t((sum[c] + weights / 2) / weights);
  return r;
}

/// Returns the premultiplied linear mean of the texels that a fragment covers. A fragment below min_centroid_area gets
/// the texel at its centroid.
GB_HD_NOINLINE Rgba16 nearest_over(const TextureView& view, NearestMap look, FragmentShape f,
                                   const std::uint16_t* linear_from_srgb) {
  const double s_middle = (look.s0 + look.su * f.centroid.u) + look.sv * f.centroid.v,
               t_middle = (look.t0 + look.tu * f.centroid.u) + look.tv * f.centroid.v;
  if (!has_centroid(f.area)) return nearest_texel(view, look.wrap_s, look.wrap_t, s_middle, t_middle, linear_from_srgb);
  const double s = in_first_period(s_middle, look.wrap_s), t = in_first_period(t_middle, look.wrap_t);
  const FragmentMap map = fragment_map(look, view.width, view.height);
  TexelOutline outline;
  map_outline(outline_of(f), map, {f.centroid.u - f.cell_u, f.centroid.v - f.cell_v}, outline);
  const TexelGrid grid = texel_grid(view, level_for(view, outline), look.wrap_s, look.wrap_t, linear_from_srgb);
  const double width = grid.width, height = grid.height;
  const TexelSpan columns = texels_between(s * width, outline.low_x * width, outline.high_x * width, grid.width),
                  rows = texels_between(t * height, outline.low_y * height, outline.high_y * height, grid.height);
  constexpr double no_size = 1.0 / (1 << 20);
  const bool is_point =
      outline.high_x - outline.low_x < no_size / width && outline.high_y - outline.low_y < no_size / height;
  if (is_point || columns.count * rows.count == 1 || grid.width * grid.height == 1)
    return grid.texel(columns.middle_texel(), rows.middle_texel());
  place_outline(width, height, columns.middle, rows.middle, outline);
  const double covered = f.area * (map.determinant * (width * height));
  return mean_of_covered(grid, columns, rows, outline, double(1 << 24) / covered);
}

}  // namespace gigabake::kernels
