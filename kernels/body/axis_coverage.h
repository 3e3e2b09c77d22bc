/// What voxels of lod 0 cover along x, y and z: what levels above them are made of.
///
/// An opaque voxel is full. One that lets light through holds a piece of a sheet with its normal n, |x| + |y| + |z|
/// = 1. Such a sheet passes through 1/|n_a| voxels of a column along axis a, in the mean, and each of them has the
/// sheet's alpha, however little of it lies there. So a voxel covers 1 - (1 - alpha)^|n_a| along a: all of a column
/// together cover what the sheet does. Where alpha is nearly 1 this is so too, whatever the normal: no sheet becomes a
/// grating.
///
/// Exact   Integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "kernels/body/plane.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// Of eight voxels: byte c of an axis's two words is voxel c's, 0 where there is none.
struct AxisCoverage {
  std::uint32_t along[3][2] = {};

  GB_HD void add(int c, const std::uint32_t coverage[3]) {
    for (int a = 0; a < 3; ++a) along[a][c / 4] |= coverage[a] << 8 * (c % 4);
  }
};

GB_HD std::uint32_t sheet_coverage(std::uint32_t alpha, std::int32_t normal_component, const Tables& tables) {
  const std::int32_t n = normal_component < 0 ? -normal_component : normal_component;
  return tables.sheet_coverage[alpha * normal_steps + std::uint32_t(n)];
}

/// rgba: packed as pack_rgba() does.
GB_HD bool is_opaque(std::uint32_t rgba) { return rgba >> 24 == 255; }

/// Of a voxel that is there. has_normals: else it covers as much along every axis.
GB_HD void coverage_of_finest(const Voxel& voxel, bool has_normals, const Tables& tables, std::uint32_t coverage[3]) {
  const std::uint32_t alpha = voxel.rgba[3];
  for (int a = 0; a < 3; ++a) coverage[a] = alpha;
  if (alpha == 255 || !has_normals) return;
  const OctahedronPoint n = octahedron_point(voxel.normal);
  for (int a = 0; a < 3; ++a) coverage[a] = sheet_coverage(alpha, n.c[a], tables);
}

}  // namespace gigabake::kernels
