/// The mean of an alpha-tested texture over a fragment. A renderer tests the interpolated alpha at every point, so the
/// share that passes is wanted, and the colour of that share.
///
/// A voxel is cut into rows and these into boxes, by its own place, not by the fragment's: so fragments of one sheet
/// add up. A fragment has of a row what its outline leaves in the row's middle. Over a box alpha is taken to be a
/// plane, by its value and gradient in the box's middle; so much of the box passes as of the plane.
///
/// Space   (u, v) in voxels, as kernels/body/coverage.h.
/// Exact   IEEE double and float without contraction, then integers: host and device agree.
/// Cost    At most 144 boxes, four texels each.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/body/coverage.h"
#include "kernels/body/filter_texture.h"
#include "kernels/body/sample_texture.h"
#include "lattice/host_device.h"
#include "lattice/rounding.h"

namespace gigabake::kernels {

/// Texture coordinates as an affine function of a triangle's (u, v).
struct TextureMap {
  double s0, su, sv, t0, tu, tv;  ///< s = s0 + su·u + sv·v
};

/// Texels that a voxel's edges cross, the larger sum; infinite for degenerate maps.
GB_HD float texels_of_voxel(const TextureMap& m, const TextureView& view) {
  const double across = (std::fabs(m.su) + std::fabs(m.sv)) * view.width,
               down = (std::fabs(m.tu) + std::fabs(m.tv)) * view.height;
  return float(at_most(larger(across, down), 1 << 30));
}

/// Where a voxel has more texels, those of coarser levels say what share of them passes.
inline constexpr float most_tested_texels = 12;

/// Boxes along a voxel's edge.
GB_HD int tested_boxes(float texels) { return larger(8, smaller(int(texels * 2) + 1, 12)); }

/// A fragment's outline with rows across its longer side, so that none slips between the middles of rows: x along them.
struct RowsOfFragment {
  const double *x, *y;
  double cell_x, cell_y;
  int corners;
  bool is_turned;  ///< x is v
};

GB_HD RowsOfFragment rows_of(const FragmentShape& f) {
  if (f.uu > f.vv) return {f.polygon_v, f.polygon_u, f.cell_v, f.cell_u, f.corners, true};
  return {f.polygon_u, f.polygon_v, f.cell_u, f.cell_v, f.corners, false};
}

/// What a row of a cell has of a fragment, in cells.
struct RowSpan {
  double low, high;  ///< none where low >= high
};

GB_HD RowSpan row_span(const RowsOfFragment& f, double y) {
  RowSpan r{1, 0};
  for (int i = 0; i < f.corners; ++i) {
    const int j = i + 1 == f.corners ? 0 : i + 1;
    if ((f.y[i] <= y) == (f.y[j] <= y)) continue;
    const double x = f.x[i] + (y - f.y[i]) * ((f.x[j] - f.x[i]) / (f.y[j] - f.y[i])) - f.cell_x;
    r.low = smaller(r.low, x);
    r.high = larger(r.high, x);
  }
  return {larger(r.low, 0.0), smaller(r.high, 1.0)};
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

/// Four texels around a point.
struct TexelSquare {
  Rgba16 texel[4];
  float x, y;  ///< from the first one

  GB_HD float at(int c) const {
    const float upper = float(texel[0].c[c]) + x * float(int(texel[1].c[c]) - int(texel[0].c[c])),
                lower = float(texel[2].c[c]) + x * float(int(texel[3].c[c]) - int(texel[2].c[c]));
    return upper + y * (lower - upper);
  }
  GB_HD float along_x(int c) const {
    const float upper = float(int(texel[1].c[c]) - int(texel[0].c[c])),
                lower = float(int(texel[3].c[c]) - int(texel[2].c[c]));
    return upper + y * (lower - upper);
  }
  GB_HD float along_y(int c) const {
    const float left = float(int(texel[2].c[c]) - int(texel[0].c[c])),
                right = float(int(texel[3].c[c]) - int(texel[1].c[c]));
    return left + x * (right - left);
  }
};

GB_HD TexelSquare square_at(const TextureView& view, const MaterialView& m, const LevelPlace& p, const Tables& tables) {
  TexelSquare r;
  r.x = float(std::int32_t(std::uint32_t(p.x) >> 8)) * (1.0f / (1 << 24));
  r.y = float(std::int32_t(std::uint32_t(p.y) >> 8)) * (1.0f / (1 << 24));
  std::uint32_t at[4];
  for (int k = 0; k < 4; ++k)
    at[k] = std::uint32_t(texel_near(std::int32_t(p.y >> 32) + (k >> 1), p.height, m.wrap_t)) * std::uint32_t(p.width) +
            std::uint32_t(texel_near(std::int32_t(p.x >> 32) + (k & 1), p.width, m.wrap_s));
  load_texels<false>(view, 0, at, tables, r.texel);
  return r;
}

/// Sums over boxes: areas in 2^-12 of a whole one, colours and alpha of what passes.
struct TestedSums {
  std::uint32_t area = 0;
  std::uint64_t passed[4] = {0, 0, 0, 0};
};

/// Adds a box around p; area: of a whole box.
GB_HD void add_box(const TextureView& view, const MaterialView& m, const TextureMap& map, Point2 p, float width,
                   float height, float area, const Tables& tables, TestedSums& sums) {
  const ImagePlace s = image_place((map.s0 + map.su * p.u) + map.sv * p.v, m.wrap_s),
                   t = image_place((map.t0 + map.tu * p.u) + map.tv * p.v, m.wrap_t);
  const TexelSquare square = square_at(view, m, level_place(view, 0, s, t), tables);
  const auto weight = std::uint32_t(area * 4096 + 0.5f);
  sums.area += weight;
  const float alpha = square.at(3);
  if (!(alpha > 0)) return;
  const float x = square.along_x(3) * float(s.is_turned ? -view.width : view.width),
              y = square.along_y(3) * float(t.is_turned ? -view.height : view.height);
  const float along_u = std::fabs(x * float(map.su) + y * float(map.tu)) * width,
              along_v = std::fabs(x * float(map.sv) + y * float(map.tv)) * height;
  const auto passed =
      std::uint32_t(float(weight) * passing_share(alpha - float(view.mask_cutoff * 257u), along_u, along_v) + 0.5f);
  for (int c = 0; c < 3; ++c)
    sums.passed[c] += std::uint64_t(passed) * std::uint32_t(smaller(square.at(c) / alpha, 1.0f) * 65535 + 0.5f);
  sums.passed[3] += std::uint64_t(passed) * 65535;
}

/// One that lies between the middles of all rows: a box of its area around its centroid.
GB_HD void add_small(const TextureView& view, const MaterialView& m, const TextureMap& map, const FragmentShape& f,
                     const Tables& tables, TestedSums& sums) {
  const float edge = std::sqrt(float(at_most(std::fabs(f.area), 1)));
  add_box(view, m, map, f.centroid, edge, edge, 1, tables, sums);
}

/// Premultiplied linear mean of what passes.
GB_HD_ONE_COPY Rgba16 tested_over(const TextureView& view, MaterialView m, TextureMap map, FragmentShape f,
                                  Tables tables) {
  const int boxes = tested_boxes(texels_of_voxel(map, view));
  const double edge = 1.0 / boxes;
  const RowsOfFragment rows = rows_of(f);
  TestedSums sums;
  GB_NO_UNROLL
  for (int j = 0; j < boxes; ++j) {
    const double y = rows.cell_y + (j + 0.5) * edge;
    const RowSpan row = row_span(rows, y);
    if (row.low >= row.high) continue;
    const int end = smaller(boxes, floor_to_int32(row.high * boxes) + 1);
    GB_NO_UNROLL
    for (int i = floor_to_int32(row.low * boxes); i < end; ++i) {
      const double low = larger(row.low, i * edge), high = smaller(row.high, (i + 1) * edge);
      if (high <= low) continue;
      const double x = rows.cell_x + (low + high) * 0.5;
      const float width = float(high - low), height = float(edge);
      add_box(view, m, map, {rows.is_turned ? y : x, rows.is_turned ? x : y}, rows.is_turned ? height : width,
              rows.is_turned ? width : height, width * float(boxes), tables, sums);
    }
  }
  if (sums.area == 0) add_small(view, m, map, f, tables, sums);
  Rgba16 r;
  for (int c = 0; c < 4; ++c) r.c[c] = std::uint16_t((sums.passed[c] + sums.area / 2) / sums.area);
  return r;
}

}  // namespace gigabake::kernels
