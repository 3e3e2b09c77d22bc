/// The conversion from metres to the sub-voxel lattice. Only this step rounds coordinates; all later steps use
/// integers.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "core/octree/brick.h"

namespace gigabake {

/// The bake's lattice in the scene frame.
struct SnapFrame {
  double voxel_size_m = 1;
  Vec3d lattice_origin_m{};  ///< lowest corner of voxel 0,0,0
};

/// A snapped vertex in sub-voxels (1/256 voxel) from the lattice origin.
struct LatticePoint {
  Vec3i64 v;
};
static_assert(sizeof(SnapFrame) == 32 && sizeof(LatticePoint) == 24);  // both are uploaded

/// The exclusive bound of |coordinate| in sub-voxels for snap(): 2^53.
inline constexpr double snap_limit = 9007199254740992.0;

/// Converts `local` (3 floats in the mesh's frame) to the lattice. Returns false if a coordinate is NaN, infinite or
/// not below snap_limit. `scene_from_local` is a 3×4 matrix in row order.
/// Exact   IEEE double without contraction: host and device return the same bits. Rounds half up (floor(x + ½)).
GB_HD bool snap(const SnapFrame& frame, const double scene_from_local[12], const float local[3], LatticePoint& out) {
  for (int r = 0; r < 3; ++r) {
    const double* m = scene_from_local + 4 * r;
    const double p_scene_m = ((m[0] * local[0] + m[1] * local[1]) + m[2] * local[2]) + m[3];
    const double q = (p_scene_m - frame.lattice_origin_m[r]) / frame.voxel_size_m * double(subvoxels);
    if (!(q > -snap_limit && q < snap_limit)) return false;
    out.v[r] = std::int64_t(std::floor(q + 0.5));
  }
  return true;
}

/// Converts `local` like snap(), but to multiples of 2^lod sub-voxels: 1/256 of a voxel of level `lod`.
/// Range   0 ≤ lod ≤ 10.
GB_HD bool snap_to_level(const SnapFrame& frame, const double scene_from_local[12], const float local[3], int lod,
                         LatticePoint& out) {
  const SnapFrame coarser{frame.voxel_size_m * double(1 << lod), frame.lattice_origin_m};
  if (!snap(coarser, scene_from_local, local, out)) return false;
  out.v = out.v * (std::int64_t(1) << lod);
  return true;
}

}  // namespace gigabake
