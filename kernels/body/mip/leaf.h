/// Surface data of a leaf: a voxel of level 1 or coarser that was voxelized at its own level. It has no children, so
/// this data takes the place of the data that the filter computes from children.
///
/// A leaf covers its cube like a voxel of lod 0: with its alpha along each axis, or as its plane states.
///
/// Exact   Integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/octree.h"
#include "core/octree/plane.h"
#include "kernels/body/mip/directional_coverage.h"
#include "kernels/body/mip/patch.h"
#include "kernels/body/mip/plane_fit.h"

namespace gigabake::kernels {

/// Returns whether the plane of a leaf crosses the centre line of cell (u, v) of a coverage mask across `axis` inside
/// the leaf. A plane on the upper face does not count. `normal` is octahedron_point().
GB_HD bool crosses_cell(const Vec3<std::int32_t>& normal, std::int32_t offset, int axis, int u, int v, int edge) {
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  const std::int32_t across = normal[first] * (2 * u + 1 - edge) + normal[second] * (2 * v + 1 - edge),
                     above = 127 * offset * edge - max_offset * across,
                     top = max_offset * edge * (normal[axis] < 0 ? -normal[axis] : normal[axis]),
                     height = normal[axis] < 0 ? -above : above;
  return height >= -top && height < top;
}

/// Sets the coverage masks of a leaf whose plane lies in a part of its columns only (crosses_cell()).
GB_HD void set_partial_raster(const Voxel& leaf, std::uint8_t plane, int edge, std::uint32_t* raster) {
  const Vec3<std::int32_t> normal = octahedron_point(leaf.normal).c;
  const int words = edge * edge / 4;
  for (int axis = 0; axis < 3; ++axis)
    for (int w = 0; w < words; ++w) {
      std::uint32_t cells = 0;
      for (int c = 0; c < 4; ++c)
        if (crosses_cell(normal, unpack_plane(plane).offset, axis, (4 * w + c) % edge, (4 * w + c) / edge, edge))
          cells |= 255u << 8 * c;
      raster[axis * words + w] = cells;
    }
}

/// Sets the coverage masks of a leaf, with `edge`² cells per axis. All cells of an axis have the coverage of a lod-0
/// voxel along this axis. A leaf of `depth_error` may have a complete plane that fills only a part of its columns
/// (alpha below 255); its cells are then covered where the plane is.
/// Range   edge ≥ 2.
GB_HD void set_leaf_raster(const Voxel& leaf, std::uint8_t plane, bool has_normals, int edge, const Tables& tables,
                           std::uint32_t* raster) {
  if (is_fully_planar(plane) && leaf.rgba[3] < 255) return set_partial_raster(leaf, plane, edge, raster);
  const Vec3<std::uint32_t> coverage = coverage_of_finest(leaf, has_normals, tables);
  const int words = edge * edge / 4;
  for (int axis = 0; axis < 3; ++axis)
    for (int w = 0; w < words; ++w) raster[axis * words + w] = coverage[axis] * 0x01010101u;
}

/// Returns the surface moments of a leaf. `plane` is its stored plane. Without one, the position of its surface is
/// unknown, and the maximal spread prevents a plane of the coarser voxel.
GB_HD SurfaceMoments leaf_patch(const Voxel& leaf, std::uint8_t plane, const Tables& tables) {
  return finest_patch(plane, unit_normal_of(leaf.normal, tables));
}

/// Sets the stored directional coverage of a leaf whose stored plane is `plane`. It is the leaf's alpha along each
/// axis, or 0 if its whole surface lies on the plane.
GB_HD void set_leaf_coverage(const Voxel& leaf, std::uint8_t plane, std::uint8_t coverage[directional_coverage_bytes]) {
  const std::uint32_t stored = stored_coverage(unpack_plane(plane), leaf.rgba[3] * 0x010101u);
  for (std::size_t axis = 0; axis < coverage_bytes; ++axis) coverage[axis] = std::uint8_t(stored >> 8 * axis);
  coverage[directional_coverage_plane] = plane;
}

}  // namespace gigabake::kernels
