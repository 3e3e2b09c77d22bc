/// Four by four cells of rippled ground, one or two voxels thick.
#pragma once

#include "voxel_scene.h"

namespace gigabake {

inline Painter rippled_ground() {
  return [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    if (z != 12 + (x + y) % 3) return {};
    return Paint{{100, 150, 50, 255}, {}};
  };
}

inline VoxelScene wide_ground(std::uint32_t cell_voxels = 32) {
  VoxelScene scene(cell_voxels);
  for (std::int64_t y = 0; y < 4; ++y)
    for (std::int64_t x = 0; x < 4; ++x) scene.add_cell(rippled_ground(), {x * cell_voxels, y * cell_voxels, 0});
  return scene;
}

}  // namespace gigabake
