/// Surface of a lod-0 voxel: its normal and its plane.
///
/// The normals of the two sides of a thin object cancel each other. Such a voxel is *two-sided*. Its normal is the mean
/// of its normals after each is turned to one half space. It points to the side that has more area; if both have the
/// same area, to the half space. The plane of a two-sided voxel lies in the middle between the sides.
///
/// Exact   Sums are exact integers; the rest is IEEE double: host and device return the same bits.
/// Source  docs/adr/0554-planes-at-level-0.md
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "kernels/body/mip/plane.h"
#include "kernels/body/voxelize/accumulate.h"

namespace gigabake::kernels {

/// A narrow weight of 1 in units of Fragment::weight is 1 / narrow_unit.
inline constexpr double narrow_unit = 1.0 / (std::int64_t(1) << 24);

struct FinestSurface {
  Vec3d normal;      ///< any length
  double coherence;  ///< length of the mean of the unit normals on either side, 0 … 1
  double distance;   ///< from the voxel's centre to the surface, along the normal; voxels
  bool has_distance;
};

/// Max length of the mean normal of a two-sided voxel, and min length of its mean turned normal. The latter excludes
/// wires, whose normals point to all directions.
inline constexpr double max_two_sided_length = 0.5, min_axis_length = 0.8;
/// Square of the cosine of the max angle between a voxel's two mean normals that counts as the same axis.
inline constexpr double same_axis = 0.97;

/// Lengths of the two mean normals of a voxel, and their mean distances.
struct FinestMeans {
  Vec3d side, axis;                 ///< sums of unchanged normals, and of normals turned to one half space
  double side_length, axis_length;  ///< lengths of the means
  double axis_distance;             ///< along `axis`; voxels

  GB_HD bool is_two_sided() const { return side_length < max_two_sided_length && axis_length >= min_axis_length; }
  GB_HD bool has_same_axis() const {
    const double along = dot(side, axis);
    return along * along >= same_axis * (dot(side, side) * dot(axis, axis)) && dot(axis, axis) > 0;
  }
};

/// Returns the means of a voxel. `visible` is the sum of weight · alpha over its fragments, in units of
/// Fragment::weight. Distances are divided by the length of the mean normal: the plane of a crease goes through the
/// intersection of the two surfaces.
template <class I>
GB_HD FinestMeans finest_means(const I sums[sum_count], double visible) {
  FinestMeans r;
  r.side = {double(sums[sum_nx]), double(sums[sum_ny]), double(sums[sum_nz])};
  r.axis = {double(sums[sum_axis_x]), double(sums[sum_axis_y]), double(sums[sum_axis_z])};
  const double axis = std::sqrt(dot(r.axis, r.axis)), length = axis / (visible * narrow_unit * 127);
  r.side_length = std::sqrt(dot(r.side, r.side)) / (visible * 32767);
  r.axis_length = length < 1 ? length : 1;
  r.axis_distance = double(sums[sum_axis_offset]) / axis * 127 / 128;
  return r;
}

/// Returns the surface of a voxel; parameters as in finest_means().
template <class I>
GB_HD FinestSurface finest_surface(const I sums[sum_count], double visible) {
  const FinestMeans m = finest_means(sums, visible);
  const bool is_turned = dot(m.side, m.axis) < 0;
  if (m.is_two_sided())
    return {is_turned ? m.axis * -1 : m.axis, m.axis_length, is_turned ? -m.axis_distance : m.axis_distance, true};
  if (m.has_same_axis())  // fragments of the other side shorten the mean normal, but not the axis
    return {m.side, m.axis_length > m.side_length ? m.axis_length : m.side_length,
            is_turned ? -m.axis_distance : m.axis_distance, true};
  const double side = std::sqrt(dot(m.side, m.side));
  return {m.side, m.side_length, double(sums[sum_offset]) / (side * narrow_unit * 128) * 32767,
          visible * narrow_unit >= 1 && side > 0};
}

/// Returns the plane of a surface. It rises to full coherence while the length of the mean normal grows from 0.65 to
/// 0.8, as at coarser levels. `normal` is the voxel's stored normal.
GB_HD Plane plane_of(const FinestSurface& surface, const std::int8_t normal[2]) {
  const double alike = (surface.coherence - 0.65) * (1 / 0.15);
  const int coherence = alike >= 1 ? max_coherence : (alike > 0 ? int(alike * max_coherence + 0.5) : 0);
  if (coherence == 0 || !surface.has_distance) return {};
  const OctahedronPoint n = octahedron_point(normal);
  const double length = std::sqrt(double(dot(n.c, n.c)));
  const double offset = std::floor(surface.distance * (2.0 * max_offset / 127) * length + 0.5);
  return {offset < -max_offset ? -max_offset : (offset > max_offset ? max_offset : int(offset)), coherence};
}

}  // namespace gigabake::kernels
