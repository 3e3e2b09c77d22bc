/// Conservative test of an instance against a cell, applied before images are decoded and triangles are snapped.
#pragma once

#include <cstdint>

#include "core/math/box3.h"
#include "core/math/vec3.h"
#include "core/octree/parameters.h"
#include "format/source/mesh.h"

namespace gigabake {

/// Local metres, over finite positions only, because a triangle with another position is dropped at the snap. low >
/// high: no position is finite.
struct LocalBounds {
  Vec3d low{1, 1, 1}, high{-1, -1, -1};
};

LocalBounds bounds_of(const Primitive& primitive);

/// Scene metres. low > high: empty.
struct SceneBox {
  Vec3d low_m{1, 1, 1}, high_m{-1, -1, -1};
  bool is_empty() const { return low_m[0] > high_m[0]; }
};

/// Returns a box that contains every voxel that a triangle of the instance can touch, with any surface rule.
/// Exact   Conservative: bounds are transformed in double and grown by a voxel and by 1e-12 of the terms that cancel.
SceneBox scene_box(const LocalBounds& bounds, const Instance& instance, const BakeParameters& parameters);

/// Returns false only if no geometry inside the box (of scene_box()) can touch a lod-0 voxel of the cell.
bool may_overlap(const SceneBox& box, const BakeParameters& parameters, const Box3i64& cell);

}  // namespace gigabake
