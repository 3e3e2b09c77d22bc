/// Shapes on the lattice of a bake: whether the centre of a voxel is inside.
///
/// Space   Sub-voxels (1/256 voxel) from the lattice origin. Centres of voxels are at 256 i + 128.
/// Exact   Coordinates and radii are rounded once, half up, like vertices (core/math/snap.h). All tests then use
///         integers without overflow: products of four coordinates have 128 bits.
/// Ties    A box and the heights of a prism are half-open: their lower bound is inside, their upper bound outside. A
///         cylinder contains its base and not its top. The surfaces of spheres and sides of cylinders are inside.
///         Polygons follow format/area/polygon.h: an eastern or northern edge is outside.
#pragma once

#include <cstdint>
#include <variant>

#include "core/math/box3.h"
#include "format/area/polygon.h"
#include "format/edit/lattice_mesh.h"

namespace gigabake {

/// Max edge of the box around a shape, in sub-voxels: 2^21 voxels.
inline constexpr std::int64_t max_shape_edge = std::int64_t(1) << 29;

/// A closed box of sub-voxel positions, or the half-open box of a shape.
struct LatticeBox {
  Vec3i64 low{}, high{};
};

struct LatticeSphere {
  Vec3i64 centre{};
  std::int64_t radius = 0;
};

/// A cylinder from `base` to `base + axis`.
struct LatticeCylinder {
  Vec3i64 base{}, axis{};
  std::int64_t radius = 0;
};

struct LatticePrism {
  AreaPolygon polygon;
  std::int64_t low = 0, high = 0;
};

using LatticeShape = std::variant<LatticeBox, LatticeSphere, LatticeCylinder, LatticePrism, LatticeMesh>;

/// Returns the closed box around a shape.
LatticeBox bounds_of(const LatticeShape& shape);

/// Returns whether the shape contains a position.
/// Range   The edges of bounds_of(shape) are at most max_shape_edge. `p` lies in bounds_of(shape).
bool contains(const LatticeShape& shape, const Vec3i64& p);

/// Classifies the positions in a closed box. May return `border` for a box that is inside or outside, but near the
/// border.
/// Range   The edges of both boxes are at most max_shape_edge.
AreaOverlap overlap(const LatticeShape& shape, const LatticeBox& box);

}  // namespace gigabake
