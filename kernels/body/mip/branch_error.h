/// The error of a leaf that takes the place of finer voxels.
///
/// A leaf describes the voxels below it if it and all of them have a complete plane, and if each of them differs
/// from it by at most `codes`:
/// - red, green and blue by at most `codes` of 255,
/// - unit normals by a chord of at most 2·codes/255,
/// - positions by at most codes/8 of an edge of the finer voxel. The position is the height of the plane along the
///   largest axis of the leaf's normal, anywhere in the column of the finer voxel along this axis.
/// Their classes are equal.
/// Coverage is compared per column of lod-0 voxels along this axis: where the leaf's plane crosses the centre line of a
/// column inside the leaf, a lod-0 voxel exists within codes/8 of an edge.
///
/// Space   Positions in half edges of the finer voxel, from the leaf's centre. `finer` is the number of levels between
///         leaf and finer voxel.
/// Exact   64-bit integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "core/octree/plane.h"
#include "kernels/body/mip/mip.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"
#include "kernels/body/voxelize/quantize_groups.h"

namespace gigabake::kernels {

/// A voxel whose whole surface lies on its plane.
struct PlanarVoxel {
  Voxel voxel;
  Vec3<std::int32_t> normal;  ///< octahedron_point()
  std::int32_t offset;        ///< of its plane, -7 … 7
};

/// Returns the voxel with its stored plane.
/// Range   is_fully_planar(plane).
GB_HD PlanarVoxel planar_voxel(const Voxel& voxel, std::uint8_t plane) {
  return {voxel, octahedron_point(voxel.normal).c, unpack_plane(plane).offset};
}

/// A leaf, seen along the largest axis of its normal. The axes `u` and `v` are the other two, in ascending order.
struct LeafPlane {
  PlanarVoxel leaf;
  int axis, u, v;
};

GB_HD LeafPlane leaf_plane(const PlanarVoxel& leaf) {
  const Vec3<std::int32_t>& n = leaf.normal;
  const std::int32_t x = n[0] < 0 ? -n[0] : n[0], y = n[1] < 0 ? -n[1] : n[1], z = n[2] < 0 ? -n[2] : n[2];
  const int axis = z > (y > x ? y : x) ? 2 : (y > x ? 1 : 0);
  return {leaf, axis, axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
}

/// A height as a fraction `above` / `per`, in half edges of a finer voxel.
struct PlaneHeight {
  std::int64_t above, per;
};

/// Returns the height of a voxel's plane along `axis`, relative to the voxel's centre. (u, v) is relative to the
/// centre. The voxel's half edge is `half` of the units of all lengths.
GB_HD PlaneHeight height_of(const PlanarVoxel& voxel, const LeafPlane& along, std::int64_t half, std::int64_t u,
                            std::int64_t v) {
  const Vec3<std::int32_t>& n = voxel.normal;
  return {std::int64_t(127) * voxel.offset * half - max_offset * (n[along.u] * u + n[along.v] * v),
          std::int64_t(max_offset) * n[along.axis]};
}

/// Returns true if two heights differ by at most codes/4 half edges. `to` is counted from a centre at height `centre`.
GB_HD bool are_close(const PlaneHeight& from, const PlaneHeight& to, std::int64_t centre, std::uint32_t codes) {
  const std::int64_t apart = from.above * to.per - (to.above + centre * to.per) * from.per, per = from.per * to.per;
  return per != 0 && 4 * (apart < 0 ? -apart : apart) <= std::int64_t(codes) * (per < 0 ? -per : per);
}

/// Returns true if the plane of a finer voxel, whose centre is at `centre`, is close to the leaf's plane.
GB_HD bool is_close(const LeafPlane& leaf, const PlanarVoxel& voxel, const Vec3<std::int32_t>& centre, int finer,
                    std::uint32_t codes) {
  for (int corner = 0; corner < 4; ++corner) {
    const int u = (corner & 1) != 0 ? 1 : -1, v = (corner & 2) != 0 ? 1 : -1;
    const PlaneHeight ours =
        height_of(leaf.leaf, leaf, std::int64_t(1) << finer, centre[leaf.u] + u, centre[leaf.v] + v);
    if (!are_close(ours, height_of(voxel, leaf, 1, u, v), centre[leaf.axis], codes)) return false;
  }
  return true;
}

/// Returns true if the leaf describes a finer voxel below it, whose centre is at `centre`.
GB_HD bool describes(const LeafPlane& leaf, const PlanarVoxel& voxel, const Vec3<std::int32_t>& centre, int finer,
                     std::uint32_t codes, const Tables& tables) {
  const Voxel &a = leaf.leaf.voxel, &b = voxel.voxel;
  for (int c = 0; c < 3; ++c) {
    const int apart = int(a.rgba[c]) - int(b.rgba[c]);
    if ((apart < 0 ? -apart : apart) > int(codes)) return false;
  }
  const auto unit = [&](const Voxel& of) {
    return static_cast<Vec3<std::int16_t>>(unit_normal_of(of.normal, tables).c);
  };
  return within_chord(unit(a), unit(b), codes) && is_close(leaf, voxel, centre, finer, codes);
}

/// The positions of lod-0 voxels in a column, from `low` to `high`, counted from the leaf's lowest face.
struct ColumnPart {
  std::int64_t low, high;
  bool is_empty;  ///< the leaf's plane crosses the column's centre line outside the leaf
};

GB_HD std::int64_t floor_ratio(std::int64_t part, std::int64_t whole) {
  const std::int64_t down = part / whole;
  return part % whole < 0 ? down - 1 : down;
}

/// Returns where column (u, v) of a leaf `finer` levels above lod 0 needs a lod-0 voxel.
GB_HD ColumnPart covered_part(const LeafPlane& leaf, int finer, int u, int v, std::uint32_t codes) {
  const std::int64_t edge = std::int64_t(1) << finer;
  PlaneHeight height = height_of(leaf.leaf, leaf, edge, 2 * u + 1 - edge, 2 * v + 1 - edge);
  if (height.per < 0) height = {-height.above, -height.per};
  const std::int64_t above = height.above + edge * height.per;  // from the lowest face, in half edges
  const std::int64_t reach = std::int64_t(codes) * height.per;
  return {floor_ratio(4 * above - reach, 8 * height.per), floor_ratio(4 * above + reach, 8 * height.per),
          above < 0 || above >= 2 * edge * height.per};
}

}  // namespace gigabake::kernels
