/// Closed surfaces on the sub-voxel lattice, wound counter-clockwise seen from outside, and which side a point is on.
#pragma once

#include <string>
#include <vector>

#include "bench/exact/exact_clip.h"
#include "triangle_families.h"

namespace gigabake::reference {

struct ClosedMesh {
  std::string name;
  std::vector<Triangle> triangles;
};

ClosedMesh box(const LatticeVertex& low, const LatticeVertex& high);
ClosedMesh sphere(const LatticeVertex& centre, double radius, int rings);
/// A sphere whose vertices stand at random distances in [nearest, farthest]: spiky, star-shaped.
ClosedMesh star(const LatticeVertex& centre, std::int64_t nearest, std::int64_t farthest, int rings, Rng& rng);
/// |x| + |y| + |z| = radius about the centre.
ClosedMesh octahedron(const LatticeVertex& centre, std::int64_t radius);
ClosedMesh torus(const LatticeVertex& centre, double radius, double tube, int segments);
/// Hull of `points` random points within `reach` of the centre; multiples of `step`.
ClosedMesh random_hull(const LatticeVertex& centre, std::int64_t reach, std::int64_t step, int points, Rng& rng);

/// Times the surface winds round the point, from solid angles in double: an integer but for rounding unless the point
/// lies on the surface. Source: Van Oosterom and Strackee 1983.
double winding_number(const std::vector<Triangle>& mesh, const LatticeVertex& point);

/// A corner of the voxel lattice lies exactly on a triangle. Range: |coordinate| < 2^20.
bool holds_lattice_corner(const std::vector<Triangle>& mesh);

/// Signed volume in sub-voxels³, exact.
mpq_class volume(const std::vector<Triangle>& mesh);

}  // namespace gigabake::reference
