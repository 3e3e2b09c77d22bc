/// Areas of the classes in a fragment whose ids are in a texture.
///
/// A texel is a square with one class. A fragment that covers more than max_class_texels texels takes squares of
/// k × k texels, k a power of two, each with the class of one of its texels. A hash selects the texel: at a fixed place
/// in its square, a repeated image would show only some of its columns.
///
/// Space   Squares of texels, relative to the first square that the fragment may overlap.
/// Exact   IEEE double without contraction, then integers of 2^-36 voxel² (weight_bits), rounded per texel.
/// Range   |s|, |t| ≤ 2^20.
/// Cost    At most max_class_texels squares per fragment, each tested against two to nine edges.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/texel_ids.h"
#include "kernels/body/texture/id_texture_view.h"
#include "kernels/body/texture/nearest_texture.h"
#include "kernels/body/texture/texture_view.h"
#include "kernels/body/voxelize/coverage.h"

namespace gigabake::kernels {

/// Max number of texels in the box of a fragment of which each counts.
inline constexpr int max_class_texels = 4096;

/// The ids of a triangle.
struct TriangleIds {
  const TextureView* texture = nullptr;  ///< null: the triangle has one class
  TexelIds texels;
  NearestMap map;
  double weight_scale;  ///< weight per projected voxel², as in TrianglePlane
};

/// Squares of texels along one axis that a fragment may overlap.
struct SquareSpan {
  double first, count;  ///< whole numbers: the first square in the wrapped row, and the number of squares
  double middle;        ///< position of the fragment's middle from the first square's lower border
};

/// Returns the squares of a fragment that extends from middle + low to middle + high, in squares.
GB_HD SquareSpan squares_between(double middle, double low, double high) {
  const double first = std::floor(middle + low), count = std::ceil(middle + high) - first;
  return {first, count < 1 ? 1 : count, middle - first};
}

/// Returns the index in the image of texel i of the wrapped row. `i` is a whole number of any size.
GB_HD std::int32_t texel_in_image(double i, std::int32_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return i < 0 ? 0 : std::int32_t(at_most(i, size - 1.0));
  const double period = 2.0 * size;
  return wrapped_texel(std::int32_t(i - std::floor(i / period) * period), size, wrap);
}

/// Returns 64 bits that look random.
GB_HD std::uint64_t hash_of_square(double column, double row) {
  std::uint64_t hash = std::uint64_t(std::int64_t(column)) * 0x9e3779b97f4a7c15ull ^
                       std::uint64_t(std::int64_t(row)) * 0xc2b2ae3d27d4eb4full;
  hash = (hash ^ hash >> 31) * 0xbf58476d1ce4e5b9ull;
  hash = (hash ^ hash >> 29) * 0x94d049bb133111ebull;
  return hash ^ hash >> 32;
}

/// A texture of ids in squares of `edge` × `edge` texels.
struct ClassGrid {
  const TriangleIds* ids;
  double edge;

  /// Returns the class of a square of the wrapped plane.
  GB_HD VoxelClass at(double column, double row) const {
    const TextureView& view = *ids->texture;
    const std::uint64_t hash = hash_of_square(column, row);
    const std::int32_t x = texel_in_image(column * edge + place(hash & 0xffffffff), view.width, ids->map.wrap_s),
                       y = texel_in_image(row * edge + place(hash >> 32), view.height, ids->map.wrap_t);
    return ids->texels.class_of(view.base + 4 * (std::size_t(y) * std::size_t(view.width) + std::size_t(x)));
  }
  /// Returns a whole number below `edge`.
  GB_HD double place(std::uint64_t hash_of_32_bits) const {
    return std::floor(double(hash_of_32_bits) * edge * (1.0 / (std::uint64_t(1) << 32)));
  }
  /// Returns the class of the square with the fragment's middle.
  GB_HD VoxelClass at_middle(const SquareSpan& columns, const SquareSpan& rows) const {
    const auto within = [](const SquareSpan& span) {
      return span.first + std::floor(span.middle < 0 ? 0 : at_most(span.middle, span.count - 0.5));
    };
    return at(within(columns), within(rows));
  }
};

/// Returns the edge of the smallest squares of which at most max_class_texels overlap the box.
GB_HD double square_edge(double across, double down) {
  double edge = 1;
  while ((across / edge + 1) * (down / edge + 1) > max_class_texels) edge *= 2;
  return edge;
}

/// Returns the class of the texel at a point of the triangle.
GB_HD VoxelClass class_at(const TriangleIds& ids, Point2 p) {
  const double s = (ids.map.s0 + ids.map.su * p.u) + ids.map.sv * p.v,
               t = (ids.map.t0 + ids.map.tu * p.u) + ids.map.tv * p.v;
  return ClassGrid{&ids, 1}.at(std::floor(in_first_period(s, ids.map.wrap_s) * ids.texture->width),
                               std::floor(in_first_period(t, ids.map.wrap_t) * ids.texture->height));
}

/// Returns the mean of the outline's corners, which lies inside it.
GB_HD Point2 middle_of(const Outline& outline) {
  Point2 sum{0, 0};
  for (int i = 0; i < outline.count; ++i) sum.u += outline.at[i].u, sum.v += outline.at[i].v;
  return {sum.u / outline.count, sum.v / outline.count};
}

/// Calls add(class, weight) for each run of covered squares in a row with one class. `weight_scale` is the weight per
/// covered square, with the sign of the outline's orientation. Returns the sum of weights.
template <class Add>
GB_HD std::int64_t add_covered(const ClassGrid& grid, const SquareSpan& columns, const SquareSpan& rows,
                               const TexelOutline& o, double weight_scale, std::int64_t max_weight, const Add& add) {
  std::int64_t total = 0;
  for (double j = 0; j < rows.count; ++j) {
    const unsigned edges = edges_in_row(o, j);
    VoxelClass of_run = no_class;
    std::int64_t run = 0;
    for (double i = 0; i < columns.count; ++i) {
      const double wanted = covered_area(o, edges, i, j) * weight_scale;
      if (!(wanted >= 0.5)) continue;
      const std::int64_t weight = floor_to_int64(at_most(wanted, double(max_weight)) + 0.5);
      const VoxelClass voxel_class = grid.at(columns.first + i, rows.first + j);
      if (run != 0 && voxel_class != of_run) {
        add(of_run, run);
        run = 0;
      }
      of_run = voxel_class;
      run += weight;
      total += weight;
    }
    if (run != 0) add(of_run, run);
  }
  return total;
}

/// Calls add(class, weight) for the classes of the texels that a fragment covers. `f` needs no centroid and variances.
/// `small_middle` is the point that decides for a fragment below min_centroid_area, and `weight` is Fragment::weight.
template <class Add>
GB_HD void for_each_class(const TriangleIds& ids, const FragmentShape& f, Point2 small_middle, std::int64_t weight,
                          const Add& add) {
  const Outline outline = outline_of(f);
  if (!has_centroid(f.area) || outline.count < 3) return add(class_at(ids, small_middle), weight);
  const NearestMap& map = ids.map;
  const double width = ids.texture->width, height = ids.texture->height;
  const Point2 in_cell = middle_of(outline), p{f.cell_u + in_cell.u, f.cell_v + in_cell.v};
  const double x = in_first_period((map.s0 + map.su * p.u) + map.sv * p.v, map.wrap_s) * width,
               y = in_first_period((map.t0 + map.tu * p.u) + map.tv * p.v, map.wrap_t) * height;
  const FragmentMap gradient = fragment_map(map, width, height);
  TexelOutline o;
  map_outline(outline, gradient, in_cell, o);
  const double across = (o.high_x - o.low_x) * width, down = (o.high_y - o.low_y) * height;
  const ClassGrid grid{&ids, square_edge(across, down)};
  const double per_x = width / grid.edge, per_y = height / grid.edge;
  const SquareSpan columns = squares_between(x / grid.edge, o.low_x * per_x, o.high_x * per_x),
                   rows = squares_between(y / grid.edge, o.low_y * per_y, o.high_y * per_y);
  constexpr double no_size = 1.0 / (1 << 20);
  if ((across < no_size && down < no_size) || columns.count * rows.count == 1)
    return add(grid.at_middle(columns, rows), weight);
  place_outline(per_x, per_y, columns.middle, rows.middle, o);
  const double scale = ids.weight_scale / (gradient.determinant * (per_x * per_y));
  if (add_covered(grid, columns, rows, o, scale, weight, add) == 0) add(grid.at_middle(columns, rows), weight);
}

}  // namespace gigabake::kernels
