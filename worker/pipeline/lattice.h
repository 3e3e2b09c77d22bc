/// Converts the bake's parameters to kernel types.
#pragma once

#include <array>
#include <cstddef>

#include "core/math/frames.h"
#include "core/math/snap.h"
#include "core/octree/parameters.h"

namespace gigabake {

inline SnapFrame snap_frame(const BakeParameters& p) { return {p.voxel_size_m, p.lattice_origin_m}; }

inline std::array<double, 12> row_major(const Affine<Scene, Local>& scene_from_local) {
  std::array<double, 12> flat;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) flat[4 * r + c] = scene_from_local.m[r][c];
  return flat;
}

}  // namespace gigabake
