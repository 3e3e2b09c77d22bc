/// Conservative test of an instance against a cell, applied before images are decoded and triangles are snapped.
#pragma once

#include <cstdint>

#include "core/math/box3.h"
#include "core/math/vec3.h"
#include "core/octree/parameters.h"
#include "format/source/mesh.h"

namespace gigabake {

/// Bounding box of a primitive's finite positions, in local metres. Other positions are ignored, because the snap drops
/// their triangles. low > high means that no position is finite.
struct LocalBounds {
  Vec3d low{1, 1, 1}, high{-1, -1, -1};
};

LocalBounds bounds_of(const Primitive& primitive);

/// A box in scene metres. low > high means that the box is empty.
struct SceneBox {
  Vec3d low_m{1, 1, 1}, high_m{-1, -1, -1};
  bool is_empty() const { return low_m[0] > high_m[0]; }
};

/// Returns a box that contains every voxel that a triangle of the instance can occupy under any surface rule.
/// Exact   The box is conservative. The transformed bounds are grown by one voxel, by the step to which vertices of
///         the coarsest sources are snapped, and by 1e-12 of the sum of the transform's absolute terms, because these
///         terms may cancel.
SceneBox scene_box(const LocalBounds& bounds, const Instance& instance, const BakeParameters& parameters);

/// Returns false only if geometry inside `box`, a result of scene_box(), cannot occupy a lod-0 voxel of the cell.
bool may_overlap(const SceneBox& box, const BakeParameters& parameters, const Box3i64& cell);

}  // namespace gigabake
