/// What a texture looks like on a fragment where its sampler picks the nearest texel: the mean of the texels that the
/// fragment covers, each by the area of it that is covered.
///
/// A texel is a square of one colour, and so is one of a coarser level, which stands in where a fragment covers many.
///
/// Space   Texels of one level, relative to the first one that the fragment may meet.
/// Exact   IEEE double without contraction, then integers: host and device agree. A fragment that covers few texels
///         (about 7 x 7) has their mean, each weight to 2^-24; one that covers more is wrong by what the coarser texels
///         along its border hold beyond it. A texture of one colour is that colour, exactly.
/// Range   |s|, |t| ≤ 2^20; beyond that, where only the gradient of a degenerate sliver leads, any texel is picked.
/// Cost    At most 130 texels a fragment, each measured against two to nine edges.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernels/body/coverage.h"
#include "kernels/body/material.h"
#include "kernels/body/sample_texture.h"
#include "kernels/body/shade.h"
#include "kernels/body/texture_view.h"
#include "lattice/host_device.h"
#include "lattice/rounding.h"
#include "lattice/rules.h"

namespace gigabake::kernels {

/// A fragment as a polygon, in voxels from its cell's lowest corner: a slab's has at most five corners, and each side
/// of the cell adds at most one.
struct Outline {
  static constexpr int most = 9;
  Point2 at[most];
  int count;

  GB_HD void add(Point2 p) {
    if (count < most) at[count++] = p;  // rounding may bend a sliver, and so cut it once more
  }
};

/// How far a point is inside one of the four sides of the unit cell.
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

/// What a fragment sees of its texture. Passed by value: a caller that hardly ever asks keeps its registers.
struct NearestLook {
  double s0, su, sv, t0, tu, tv;  ///< as TextureMap
  Wrap wrap_s, wrap_t;
};

GB_HD NearestLook nearest_look(const MaterialView& m, const TextureMap& map) {
  return {map.s0, map.su, map.sv, map.t0, map.tu, map.tv, m.wrap_s, m.wrap_t};
}

/// s in the first of the images, or pairs of images, that look alike.
GB_HD double in_first_period(double s, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return s;
  return wrap == Wrap::repeat ? s - std::floor(s) : s - 2 * std::floor(s * 0.5);
}

/// Texel i of the endless row that an image of `size` texels wraps to. Range  |i| < 2^30.
GB_HD std::int32_t wrapped_texel(std::int32_t i, std::int32_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return i < 0 ? 0 : smaller(i, size - 1);
  const std::int32_t period = wrap == Wrap::repeat ? size : 2 * size, rest = i % period,
                     at = rest < 0 ? rest + period : rest;
  return at < size ? at : period - 1 - at;
}

/// The finest level is taken at which no more than so many texels fit into a fragment's box.
inline constexpr int most_texels_inside = 64;

/// Texels along one axis that a footprint may meet.
struct TexelSpan {
  std::int32_t first, count;  ///< of the endless row
  double middle;              ///< the centroid, from the first texel's lower border

  GB_HD std::int32_t middle_texel() const { return first + std::int32_t(at_most(middle, count - 0.5)); }
};

/// middle: of the fragment on the endless row; it reaches from middle + low to middle + high. Far beyond a clamped
/// edge the first texel is moved, since all look alike there.
GB_HD TexelSpan texels_between(double middle, double low, double high, std::int32_t size) {
  constexpr double most = most_texels_inside + 2;
  const double first = std::floor(middle + low), count = std::ceil(middle + high) - first;
  const double near = first < -most ? -most : at_most(first, 2.0 * size);
  return {std::int32_t(near), std::int32_t(count < 1 ? 1 : at_most(count, most)), middle - first};
}

/// One texel of the image, linear and premultiplied; with an alpha test it is opaque or absent.
GB_HD Rgba16 base_texel(const std::uint8_t* rgba, std::uint8_t mask_cutoff, const std::uint16_t* linear_from_srgb) {
  std::uint8_t p[4];
  copy_texel<4>(rgba, p);
  const std::uint32_t alpha = mask_cutoff == 0 ? p[3] * 257u : (p[3] >= mask_cutoff ? 65535u : 0u);
  Rgba16 r;
  for (int c = 0; c < 3; ++c) r.c[c] = scale16(linear_from_srgb[p[c]], alpha);
  r.c[3] = std::uint16_t(alpha);
  return r;
}

/// One level of a texture as the sampler wraps it.
struct TexelGrid {
  const TextureView* view;
  std::int32_t level, width, height;
  Wrap wrap_s, wrap_t;
  const std::uint16_t* linear_from_srgb;

  /// Texel (x, y) of the endless plane.
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

/// The texel at (s, t), as a renderer picks it.
GB_HD Rgba16 nearest_texel(const TextureView& view, Wrap wrap_s, Wrap wrap_t, double s, double t,
                           const std::uint16_t* linear_from_srgb) {
  const TexelGrid grid = texel_grid(view, 0, wrap_s, wrap_t, linear_from_srgb);
  return grid.texel(texels_between(in_first_period(s, wrap_s) * grid.width, 0, 0, grid.width).first,
                    texels_between(in_first_period(t, wrap_t) * grid.height, 0, 0, grid.height).first);
}

/// How (s, t) runs over a fragment's (u, v). A map that is flat, as those of colours along a line are, gets a
/// thousandth of its length as width, so that what it shows has an area.
struct FragmentMap {
  double su, sv, tu, tv, determinant;
};

GB_HD FragmentMap fragment_map(const NearestLook& look, double width, double height) {
  constexpr double least = 1.0 / 1024;
  double xu = look.su * width, xv = look.sv * width, yu = look.tu * height, yv = look.tv * height;
  const double along_u = xu * xu + yu * yu, along_v = xv * xv + yv * yv, longer = larger(along_u, along_v);
  const double determinant = xu * yv - xv * yu, across = determinant < 0 ? -least : least;
  if (std::fabs(determinant) < least * longer) {
    const bool moves_v = along_u >= along_v;
    const double dx = across * (moves_v ? -yu : yv), dy = across * (moves_v ? xu : -xv);
    (moves_v ? xv : xu) += dx;
    (moves_v ? yv : yu) += dy;
  }
  return {xu / width, xv / width, yu / height, yv / height, (xu * yv - xv * yu) / (width * height)};
}

/// A fragment's corners on the texture, relative to its centroid; in images, then in texels.
struct TexelOutline {
  double x[Outline::most], y[Outline::most];
  Line line[Outline::most];
  double low_x, high_x, low_y, high_y;
  int count;
};

/// Into `r`, not as a result: nvcc 13.0 puts a result's corners where `o` lies, and overwrites its fifth before it is
/// read. Found on 2026-11-23, in colours of a device (DeviceTextures) and then in its PTX.
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

/// The finest level with few texels in the outline's box.
GB_HD int level_for(const TextureView& view, const TexelOutline& o) {
  const double across = o.high_x - o.low_x, down = o.high_y - o.low_y;
  int l = 0;
  while (l + 1 < view.levels &&
         (across * level_extent(view.width, l) + 1) * (down * level_extent(view.height, l) + 1) > most_texels_inside)
    ++l;
  return l;
}

/// From images around the centroid to texels from the first one.
GB_HD void place_outline(const TexelGrid& grid, const TexelSpan& columns, const TexelSpan& rows, TexelOutline& o) {
  for (int i = 0; i < o.count; ++i) {
    o.x[i] = columns.middle + o.x[i] * grid.width;
    o.y[i] = rows.middle + o.y[i] * grid.height;
  }
  for (int i = 0; i < o.count; ++i) {
    const int j = i + 1 == o.count ? 0 : i + 1;
    o.line[i] = line_along(o.x[j] - o.x[i], o.y[j] - o.y[i]);
  }
}

/// Bit i: edge i passes through the row of texels.
GB_HD unsigned edges_in_row(const TexelOutline& o, double row) {
  unsigned edges = 0;
  for (int i = 0; i < o.count; ++i) {
    const double a = o.y[i], b = o.y[i + 1 == o.count ? 0 : i + 1];
    if (larger(a, b) > row && smaller(a, b) < row + 1 && a != b) edges |= 1u << i;
  }
  return edges;
}

/// Edges left of the texel bound nothing of it, and those on its right all that they pass of its row: most do either.
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

/// weight_scale: of a covered texel², signed as the outline turns.
GB_HD Rgba16 mean_of_covered(const TexelGrid& grid, const TexelSpan& columns, const TexelSpan& rows,
                             const TexelOutline& o, double weight_scale) {
  constexpr double most_weight = 1 << 30;  // what is covered adds up to 2^24: only rounding could lead beyond
  std::uint64_t sum[4] = {0, 0, 0, 0}, weights = 0;
  for (std::int32_t j = 0; j < rows.count; ++j) {
    const unsigned edges = edges_in_row(o, j);
    for (std::int32_t i = 0; i < columns.count; ++i) {
      const double wanted = at_most(covered_area(o, edges, i, j) * weight_scale, most_weight);
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

/// Premultiplied linear mean of the texels that a fragment covers; its centroid's texel where the fragment is too small
/// to be measured.
GB_HD_ONE_COPY Rgba16 nearest_over(const TextureView& view, NearestLook look, FragmentShape f,
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
  place_outline(grid, columns, rows, outline);
  const double covered = f.area * (map.determinant * (width * height));
  return mean_of_covered(grid, columns, rows, outline, double(1 << 24) / covered);
}

}  // namespace gigabake::kernels
