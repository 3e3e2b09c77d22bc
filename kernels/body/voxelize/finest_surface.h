/// Surface of a lod-0 voxel: its normal and its plane.
///
/// The normals of the two sides of a thin object cancel each other. Such a voxel is *two-sided*. Its normal is the mean
/// of its normals after each is turned to one half space. It points to the side that has more area; if both have the
/// same area, to the half space. The plane of a two-sided voxel lies in the middle between the sides.
///
/// Exact   Sums are exact integers; the rest is IEEE double: host and device return the same bits.
/// Source  docs/adr/0554-planes-at-level-0.md, docs/adr/0564-sums-of-the-lower-half-space.md
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "core/octree/plane.h"
#include "kernels/body/voxelize/accumulate.h"

namespace gigabake::kernels {

/// Surface of a voxel, in the units of its sums.
struct FinestSurface {
  Vec3d normal;           ///< any length
  double squared_length;  ///< of the sum of its unit normals, on one or on either side
  double offset;          ///< sum of distances from the voxel's centre, along the normal
  double squared_norm;    ///< squared length of the sum of normals that `offset` belongs to
};

/// Max length of the mean normal of a two-sided voxel, and min length of its mean turned normal. The latter excludes
/// wires, whose normals point to all directions.
inline constexpr double max_two_sided_length = 0.5, min_axis_length = 0.8;
/// Square of the cosine of the max angle between a voxel's two mean normals that counts as the same axis.
inline constexpr double same_axis = 0.97;

/// Returns an upper bound of the area of a voxel's opaque fragments. It exceeds the area by at most 2^-12 voxel² per
/// fragment.
template <class I>
GB_HD double opaque_area_of(const I sums[sum_count]) {
  return double(sums[sum_opaque]) * double(1 << narrow_area_bits);
}

/// Tests whether a voxel has a plane: it is opaque, no translucent content of it is visible, and its area is at most
/// max_narrow_area. Other content would move the plane of the opaque surface. Content that is cut away changes nothing.
/// `visible` is the sum of weight · alpha.
template <class I>
GB_HD bool has_plane(const I sums[sum_count], double visible) {
  return sums[sum_opaque] != 0 && visible <= max_narrow_area &&
         (sums[sum_clear] == 0 || opaque_area_of(sums) >= visible);
}

/// Returns the square of the length that the sum of a voxel's normals has if all are equal. `visible` is the
/// sum of weight · alpha.
GB_HD double squared_length_of_equal_normals(double visible) { return visible * 32767 * (visible * 32767); }

/// Returns the surface of a voxel. `visible` is the sum of weight · alpha.
template <class I>
GB_HD FinestSurface finest_surface(const I sums[sum_count], double visible) {
  const double whole = squared_length_of_equal_normals(visible);
  const Vec3d side = {double(sums[sum_nx]), double(sums[sum_ny]), double(sums[sum_nz])};
  const double squared_side = dot(side, side);
  const FinestSurface one_side{side, squared_side, double(sums[sum_offset]), squared_side};
  const bool has_lower = (sums[sum_lower_x] | sums[sum_lower_y] | sums[sum_lower_z] | sums[sum_lower_offset]) != 0;
  if (!has_lower || visible > max_narrow_area) return one_side;
  constexpr double unit = double(std::int64_t(1) << (narrow_normal_bits + 1));
  const Vec3d lower = {double(sums[sum_lower_x]), double(sums[sum_lower_y]), double(sums[sum_lower_z])};
  const Vec3d axis = side - lower * unit;
  const double squared_axis = dot(axis, axis), along = dot(side, axis), sign = along < 0 ? -1 : 1;
  const double offset = sign * double(sums[sum_offset] - 2 * sums[sum_lower_offset]);
  if (squared_side < max_two_sided_length * max_two_sided_length * whole &&
      squared_axis >= min_axis_length * min_axis_length * whole)
    return {axis * sign, squared_axis, offset, squared_axis};
  if (squared_axis > 0 && along * along >= same_axis * (squared_side * squared_axis))
    return {side, squared_axis > squared_side ? squared_axis : squared_side, offset,
            squared_axis};  // fragments of the other side shorten the mean normal, but not the axis
  return one_side;
}

/// Returns the plane of a surface. It rises to full coherence while the length of the mean normal grows from 0.65 to
/// 0.8, as at coarser levels: one third is reached at 0.675, 0.725 and 0.775. The distance is divided by the length of
/// the mean normal: the plane of a crease goes through the intersection of the two surfaces. `visible` is as in
/// finest_surface(), and `normal` is the voxel's stored normal.
GB_HD Plane plane_of(const FinestSurface& surface, double visible, const std::int8_t normal[2]) {
  const double squared = surface.squared_length, whole = squared_length_of_equal_normals(visible);
  const int coherence = int(squared >= 0.675 * 0.675 * whole) + int(squared >= 0.725 * 0.725 * whole) +
                        int(squared >= 0.775 * 0.775 * whole);
  if (coherence == 0 || !(surface.squared_norm > 0)) return {};
  constexpr double half_edges = 2 / 128.0, unit = half_edges * max_offset * 32767 * (1 << narrow_offset_bits);
  const OctahedronPoint n = octahedron_point(normal);
  const double scale = std::sqrt(double(dot(n.c, n.c)) / surface.squared_norm);
  const double offset = std::floor(surface.offset * (unit / 127) * scale + 0.5);
  return {offset < -max_offset ? -max_offset : (offset > max_offset ? max_offset : int(offset)), coherence};
}

}  // namespace gigabake::kernels
