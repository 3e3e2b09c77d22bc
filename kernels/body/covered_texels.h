/// What a texture looks like on a fragment, by the fragment's own outline: the mean of what it covers, each texel by
/// the area of it that is covered. However a sheet is cut into triangles, their fragments add up to the same.
///
/// Where the sampler picks the nearest texel, a texel is a square of one colour. Where it interpolates, the texture is
/// bilinear on the squares between the middles of four texels, patches: its integral over what is covered of a patch
/// is the four texels by moments. For an alpha test patches are cut into parts, on which alpha is taken to be linear. A
/// texel of a coarser level, which stands in where a fragment covers many, is a square of one colour too.
///
/// Exact   IEEE double without contraction, then integers: host and device agree. A fragment that covers few texels
///         (about 7 x 7, interpolated 14 x 14) has their mean, each weight to 2^-24; one that covers more is wrong by
///         what the coarser texels along its border hold beyond it. A texture of one colour is that colour, exactly.
/// Range   |s|, |t| ≤ 2^20; beyond that, where only the gradient of a degenerate sliver leads, any texel is picked.
/// Cost    At most some 300 parts a fragment, each measured against two to nine edges.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/body/brick_triangle.h"
#include "kernels/body/coverage.h"
#include "kernels/body/material.h"
#include "kernels/body/shade.h"
#include "kernels/body/texel_grid.h"
#include "kernels/body/texel_outline.h"
#include "kernels/body/texture_view.h"
#include "lattice/host_device.h"
#include "lattice/rounding.h"
#include "lattice/rules.h"

namespace gigabake::kernels {

/// What a fragment sees of its texture. Passed by value: a caller that hardly ever asks keeps its registers.
struct TexelLook {
  double s0, su, sv, t0, tu, tv;  ///< as TextureMap
  Wrap wrap_s, wrap_t;
  bool nearest;
};

GB_HD TexelLook texel_look(const MaterialView& m, const TextureMap& map) {
  return {map.s0, map.su, map.sv, map.t0, map.tu, map.tv, m.wrap_s, m.wrap_t, m.nearest};
}

/// What is added up of a fragment: weights of 2^-24 of it.
struct TexelSum {
  std::uint64_t of[4] = {0, 0, 0, 0}, weights = 0;

  GB_HD void add(std::uint64_t weight, const Rgba16& texel) {
    for (int c = 0; c < 4; ++c) of[c] += weight * texel.c[c];
    weights += weight;
  }
  GB_HD Rgba16 mean() const {
    Rgba16 r;
    for (int c = 0; c < 4; ++c) r.c[c] = std::uint16_t((of[c] + weights / 2) / weights);
    return r;
  }
};

/// The whole number next to x, of 0 … most.
GB_HD std::uint64_t whole_weight(double x, double most) {
  return std::uint64_t(floor_to_int64((x > 0 ? at_most(x, most) : 0) + 0.5));
}

/// The texels, or parts of them, that an outline may meet.
struct CoveredBox {
  TexelSpan columns, rows;
  double weight_scale;  ///< of a covered texel², signed as the outline turns
};

/// Calls add(x, y, weight, moments) for whatever has a weight.
template <Moments wanted, class Add>
GB_HD void each_covered(const CoveredBox& box, const TexelOutline& o, const Add& add) {
  constexpr double most_weight = 1 << 30;  // what is covered adds up to 2^24: only rounding could lead beyond
  for (std::int32_t j = 0; j < box.rows.count; ++j) {
    const unsigned edges = edges_in_row(o, j);
    for (std::int32_t i = 0; i < box.columns.count; ++i) {
      const CellMoments part = covered_part<wanted>(o, edges, i, j);
      const std::uint64_t weight = whole_weight(part.area * box.weight_scale, most_weight);
      if (weight != 0) add(box.columns.first + i, box.rows.first + j, weight, part);
    }
  }
}

GB_HD void add_squares(const TexelGrid& grid, const CoveredBox& box, const TexelOutline& o, TexelSum& sum) {
  each_covered<Moments::area>(box, o, [&](std::int32_t x, std::int32_t y, std::uint64_t weight, const CellMoments&) {
    sum.add(weight, grid.texel(x, y));
  });
}

/// A texel's weight is the integral of its tent: of (1 - u)(1 - v), u(1 - v), (1 - u)v, uv on the patch.
GB_HD void add_patches(const TexelGrid& grid, const CoveredBox& box, const TexelOutline& o, TexelSum& sum) {
  each_covered<Moments::second>(
      box, o, [&](std::int32_t x, std::int32_t y, std::uint64_t weight, const CellMoments& part) {
        const std::uint64_t u = whole_weight(part.u * box.weight_scale, double(weight)),
                            v = whole_weight(part.v * box.weight_scale, double(weight)),
                            uv = larger(whole_weight(part.uv * box.weight_scale, double(smaller(u, v))),
                                        u + v > weight ? u + v - weight : 0);
        Rgba16 texel[4];
        grid.four_texels(x, y, texel);
        sum.add(weight - u - v + uv, texel[0]);
        sum.add(u - uv, texel[1]);
        sum.add(v - uv, texel[2]);
        sum.add(uv, texel[3]);
      });
}

/// Which part of a square passes a test, where alpha is `above` the cutoff at its middle and changes by dx and dy from
/// one side to the other: 0 … 1.
GB_HD float share_above(float above, float dx, float dy) {
  const float p = larger(std::fabs(dx), std::fabs(dy)), q = smaller(std::fabs(dx), std::fabs(dy));
  const float high = 0.5f * (p + q), off = std::fabs(above);
  if (off >= high) return above < 0 ? 0.0f : 1.0f;
  if (off <= 0.5f * (p - q)) return 0.5f + above / p;
  const float corner = (high - off) * (high - off) / (2 * p * q);
  return above < 0 ? corner : 1 - corner;
}

/// Four texels as a bilinear function of (x, y), 0 … 1.
GB_HD float bilinear(const Rgba16 texel[4], int c, float x, float y) {
  const float upper = texel[0].c[c] + x * (float(texel[1].c[c]) - float(texel[0].c[c])),
              lower = texel[2].c[c] + x * (float(texel[3].c[c]) - float(texel[2].c[c]));
  return upper + y * (lower - upper);
}

/// A part of a patch around (x, y) of it, `size` wide: opaque where alpha reaches the cutoff.
GB_HD Rgba16 tested_part(const Rgba16 texel[4], float x, float y, float size, std::uint8_t cutoff) {
  const float alpha = bilinear(texel, 3, x, y), dx = size * (bilinear(texel, 3, 1, y) - bilinear(texel, 3, 0, y)),
              dy = size * (bilinear(texel, 3, x, 1) - bilinear(texel, 3, x, 0));
  const float share = share_above(alpha - float(cutoff * 257), dx, dy);
  Rgba16 r{{0, 0, 0, 0}};
  if (share <= 0 || alpha <= 0) return r;
  for (int c = 0; c < 3; ++c)
    r.c[c] = std::uint16_t(share * at_most(bilinear(texel, c, x, y) / alpha, 1.0) * 65535 + 0.5);
  r.c[3] = std::uint16_t(share * 65535 + 0.5f);
  return r;
}

/// grid: of the image; the box is of parts, 2^shift along a patch's side.
GB_HD void add_tested(const TexelGrid& grid, int shift, const CoveredBox& box, const TexelOutline& o, TexelSum& sum) {
  const float size = 1.0f / float(1 << shift);
  each_covered<Moments::first>(
      box, o, [&](std::int32_t x, std::int32_t y, std::uint64_t weight, const CellMoments& part) {
        const std::int32_t inside = (1 << shift) - 1;
        const double inverse = 1 / part.area;
        const float u = float(x & inside) + float(clamp01(part.u * inverse)),
                    v = float(y & inside) + float(clamp01(part.v * inverse));
        Rgba16 texel[4];
        grid.four_texels(x >> shift, y >> shift, texel);
        const float covered = std::sqrt(float(at_most(std::fabs(part.area), 1)));
        sum.add(weight, tested_part(texel, u * size, v * size, covered * size, grid.view->mask_cutoff));
      });
}

/// Where a fragment's mean is taken: on a level's texels, or on patches of the image in 2^shift parts a side.
struct CoveredGrid {
  int level, shift;
  bool patches;
};

/// Texels or parts in the outline's box, of which an image has width x height.
GB_HD double inside_box(const TexelOutline& o, double width, double height) {
  return ((o.high_x - o.low_x) * width + 1) * ((o.high_y - o.low_y) * height + 1);
}

/// The finest with few of them.
GB_HD CoveredGrid grid_for(const TextureView& view, bool nearest, const TexelOutline& o) {
  constexpr int most_shift = 4;
  const int most = nearest ? most_nearest_inside : most_parts_inside;
  const bool may_cut = view.mask_cutoff != 0 && larger(view.width, view.height) <= 1 << 22;
  if (!nearest)
    for (int shift = may_cut ? most_shift : 0; shift >= 0; --shift) {
      const double parts = 1 << shift;
      if (inside_box(o, view.width * parts, view.height * parts) <= most) return {0, shift, true};
    }
  int l = 0;
  while (l + 1 < view.levels && inside_box(o, level_extent(view.width, l), level_extent(view.height, l)) > most) ++l;
  return {l, 0, false};
}

/// (s, t): the centroid's, in the first period. From here on the outline is in texels, or parts, of the box.
GB_HD CoveredBox place_in_box(const TexelGrid& grid, const CoveredGrid& way, double s, double t, TexelOutline& o) {
  const double parts = way.patches ? 1 << way.shift : 1, from = way.patches ? 0.5 * parts : 0;
  const double width = grid.width * parts, height = grid.height * parts;
  CoveredBox box;
  box.columns = texels_between(s * width - from, o.low_x * width, o.high_x * width, std::int32_t(width));
  box.rows = texels_between(t * height - from, o.low_y * height, o.high_y * height, std::int32_t(height));
  place_outline(box.columns.middle, box.rows.middle, width, height, o);
  box.weight_scale = double(1 << 24) / (width * height);
  return box;
}

GB_HD bool is_point(const TexelOutline& o, double width, double height) {
  constexpr double no_size = 1.0 / (1 << 20);
  return o.high_x - o.low_x < no_size / width && o.high_y - o.low_y < no_size / height;
}

GB_HD Rgba16 texture_at(const TextureView& view, const TexelLook& look, double s, double t, const Tables& tables) {
  if (look.nearest) return nearest_texel(view, look.wrap_s, look.wrap_t, s, t, tables);
  return magnified(view, look.wrap_s, look.wrap_t, s, t, tables);
}

/// Premultiplied linear mean of the texture that a fragment covers; what is at its centroid where the fragment is too
/// small to be measured.
GB_HD_ONE_COPY Rgba16 texels_over(const TextureView& view, TexelLook look, FragmentShape f, Tables tables) {
  const double s_middle = (look.s0 + look.su * f.centroid.u) + look.sv * f.centroid.v,
               t_middle = (look.t0 + look.tu * f.centroid.u) + look.tv * f.centroid.v;
  if (!has_centroid(f.area)) return texture_at(view, look, s_middle, t_middle, tables);
  const double s = in_first_period(s_middle, look.wrap_s), t = in_first_period(t_middle, look.wrap_t);
  const FragmentMap map = fragment_map(look.su, look.sv, look.tu, look.tv, view.width, view.height);
  TexelOutline outline;
  map_outline(outline_of(f), map, {f.centroid.u - f.cell_u, f.centroid.v - f.cell_v}, outline);
  const CoveredGrid way = grid_for(view, look.nearest, outline);
  const TexelGrid grid = texel_grid(view, way.level, look.wrap_s, look.wrap_t, tables);
  if (is_point(outline, grid.width, grid.height) || grid.width * grid.height == 1)
    return texture_at(view, look, s, t, tables);
  CoveredBox box = place_in_box(grid, way, s, t, outline);
  box.weight_scale /= f.area * map.determinant;
  TexelSum sum;
  if (!way.patches)
    add_squares(grid, box, outline, sum);
  else if (view.mask_cutoff != 0)
    add_tested(grid, way.shift, box, outline, sum);
  else
    add_patches(grid, box, outline, sum);
  return sum.weights != 0 ? sum.mean() : texture_at(view, look, s, t, tables);
}

}  // namespace gigabake::kernels
