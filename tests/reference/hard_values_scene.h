/// Shared code of the hard values: squares that fill the cross-section of one voxel, and the resulting voxel.
#pragma once

#include <gtest/gtest.h>

#include "bake_scene.h"

namespace gigabake::reference {

/// Returns a horizontal square of one voxel², as two triangles in voxel (0, 0, z/256) that face up. Its height is z
/// sub-voxels.
inline std::vector<Triangle> sheet_at(std::int64_t z) {
  return {{{{0, 0, z}, {256, 0, z}, {256, 256, z}}}, {{{0, 0, z}, {256, 256, z}, {0, 256, z}}}};
}

inline std::vector<Triangle> reversed(std::vector<Triangle> mesh) {
  for (Triangle& t : mesh) std::swap(t[1], t[2]);
  return mesh;
}

inline VoxelMap baked(const BakeScene& scene) { return voxels_at(scene.bake(), scene.parameters, 0); }

/// Returns the scene's only voxel. If the scene has no voxel or several, reports a failure.
inline BakedVoxel only_voxel(const BakeScene& scene) {
  const VoxelMap voxels = baked(scene);
  EXPECT_EQ(voxels.size(), 1u);
  return voxels.size() == 1 ? voxels.begin()->second : BakedVoxel{};
}

inline void expect_colour(const BakedVoxel& v, double red, double green, double blue) {
  EXPECT_LE(code_error(v.rgba[0], red), 0.501);
  EXPECT_LE(code_error(v.rgba[1], green), 0.501);
  EXPECT_LE(code_error(v.rgba[2], blue), 0.501);
}

inline constexpr Rgba16 red16{65535, 0, 0, 65535}, green16{0, 65535, 0, 65535}, black16{0, 0, 0, 65535};

}  // namespace gigabake::reference
