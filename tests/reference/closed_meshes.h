/// Closed surfaces on the sub-voxel lattice, counter-clockwise seen from outside, and a test for the side of a point.
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
/// Returns a spiky, star-shaped sphere whose vertices have random radii between the two bounds.
ClosedMesh star(const LatticeVertex& centre, std::int64_t nearest, std::int64_t max_distance, int rings, Rng& rng);
/// Returns the octahedron |x| + |y| + |z| = radius about the centre.
ClosedMesh octahedron(const LatticeVertex& centre, std::int64_t radius);
ClosedMesh torus(const LatticeVertex& centre, double radius, double tube, int segments);
/// Returns the hull of `points` random points within `reach` of the centre, at multiples of `step`.
ClosedMesh random_hull(const LatticeVertex& centre, std::int64_t reach, std::int64_t step, int points, Rng& rng);

/// Returns the winding number of the surface about the point, computed from solid angles in double. It is an integer up
/// to rounding unless the point lies on the surface.
/// Source  Van Oosterom and Strackee 1983.
double winding_number(const std::vector<Triangle>& mesh, const LatticeVertex& point);

/// Returns true if a corner of the voxel lattice lies exactly on a triangle.
/// Range   |coordinate| < 2^20.
bool holds_lattice_corner(const std::vector<Triangle>& mesh);

/// Returns the exact signed volume in sub-voxels³.
mpq_class volume(const std::vector<Triangle>& mesh);

}  // namespace gigabake::reference
