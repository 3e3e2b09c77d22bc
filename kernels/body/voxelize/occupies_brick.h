/// Exact test whether a triangle occupies a voxel of a brick.
///
/// Exact   Integers: host and device return the same answer. It is the test of the voxelizer, so it does not depend on
///         the window.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/body/voxelize/triangle_bricks.h"

namespace gigabake::kernels {

/// Returns true if the triangle occupies a voxel of brick `key`.
GB_HD bool occupies_brick(const WindowTriangle& triangle, std::uint64_t key, SurfaceRule rule) {
  std::uint64_t slab[8] = {};
  const Vec3<std::int32_t> corner = brick_corner(key);
  with_integer_for(triangle, [&]<class I>(I) { touched_voxels(make_brick_triangle<I>(triangle, corner), rule, slab); });
  std::uint64_t any = 0;
  for (const std::uint64_t cells : slab) any |= cells;
  return any != 0;
}

}  // namespace gigabake::kernels
