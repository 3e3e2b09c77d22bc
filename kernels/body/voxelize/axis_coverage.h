/// Coverage of lod-0 voxels along x, y and z: the input of all coarser levels.
///
/// An opaque voxel has full coverage. A translucent voxel contains a piece of a surface. Its normal n is scaled so that
/// |nx| + |ny| + |nz| = 1. On average, the surface then passes through 1/|na| voxels of a line of voxels along axis a.
/// Each of these voxels has the surface's alpha, even if its piece is small. The coverage of a voxel along a is
/// therefore 1 - (1 - alpha)^|na|, so that the line of voxels has the coverage of the surface. If alpha is nearly 1,
/// coverage is nearly full for any normal, so that such surfaces show no stripes.
///
/// Exact   Integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "core/octree/plane.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Coverage of eight voxels along each axis. Byte c of the two words along[a] is the coverage of voxel c along axis a;
/// it is 0 if the voxel does not exist.
struct AxisCoverage {
  std::uint32_t along[3][2] = {};

  GB_HD void add(int c, const Vec3<std::uint32_t>& coverage) {
    for (int a = 0; a < 3; ++a) along[a][c / 4] |= coverage[a] << 8 * (c % 4);
  }
};

GB_HD std::uint32_t planar_coverage(std::uint32_t alpha, std::int32_t normal_component, const Tables& tables) {
  const std::int32_t n = normal_component < 0 ? -normal_component : normal_component;
  return tables.planar_coverage[alpha * normal_steps + std::uint32_t(n)];
}

/// Returns true if alpha is 255. `rgba` is packed by pack_rgba().
GB_HD bool is_opaque(std::uint32_t rgba) { return rgba >> 24 == 255; }

/// Returns the coverage of an existing lod-0 voxel along each axis. Without normals it is equal along all axes.
GB_HD Vec3<std::uint32_t> coverage_of_finest(const Voxel& voxel, bool has_normals, const Tables& tables) {
  const std::uint32_t alpha = voxel.rgba[3];
  if (alpha == 255 || !has_normals) return Vec3<std::uint32_t>::all(alpha);
  const OctahedronPoint n = octahedron_point(voxel.normal);
  return Vec3<std::uint32_t>::by_axis([&](int a) { return planar_coverage(alpha, n.c[a], tables); });
}

}  // namespace gigabake::kernels
