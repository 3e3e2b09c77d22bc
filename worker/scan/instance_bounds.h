/// Conservative test of an instance against a cell, applied before images are decoded and triangles are snapped.
#pragma once

#include <array>
#include <cstdint>

#include "core/octree/parameters.h"
#include "format/source/mesh.h"

namespace gigabake {

/// Local metres, over finite positions only, because a triangle with another position is dropped at the snap. low >
/// high: no position is finite.
struct LocalBounds {
  std::array<double, 3> low{1, 1, 1}, high{-1, -1, -1};
};

LocalBounds bounds_of(const Primitive& primitive);

/// Scene metres. low > high: empty.
struct SceneBox {
  std::array<double, 3> low_m{1, 1, 1}, high_m{-1, -1, -1};
  bool is_empty() const { return low_m[0] > high_m[0]; }
};

/// Returns a box that contains every voxel that a triangle of the instance can touch, with any surface rule.
/// Exact   Conservative: bounds are transformed in double and grown by a voxel and by 1e-12 of the terms that cancel.
SceneBox scene_box(const LocalBounds& bounds, const Instance& instance, const BakeParameters& parameters);

struct CellBox {
  std::array<std::int64_t, 3> lattice_min{};  ///< lod-0 voxels
  std::uint32_t cell_voxels = 0;
};

/// Returns false only if no geometry inside the box (of scene_box()) can touch a voxel of the cell.
bool may_overlap(const SceneBox& box, const BakeParameters& parameters, const CellBox& cell);

}  // namespace gigabake
