/// Closed surfaces on the sub-voxel lattice, wound counter-clockwise seen from outside, and which side a point is on.
#pragma once

#include <string>
#include <vector>

#include "exact_clip.h"
#include "triangle_families.h"

namespace gigabake::reference {

struct ClosedMesh {
  std::string name;
  std::vector<Triangle> triangles;
};

ClosedMesh box(const LatticeVertex& low, const LatticeVertex& high);
ClosedMesh sphere(const LatticeVertex& centre, double radius, int rings);
ClosedMesh torus(const LatticeVertex& centre, double radius, double tube, int segments);
/// Hull of `points` random points within `reach` of the centre; multiples of `step`.
ClosedMesh random_hull(const LatticeVertex& centre, std::int64_t reach, std::int64_t step, int points, Rng& rng);

/// Times the surface winds round the point, from solid angles in double: an integer but for rounding unless the point
/// lies on the surface. Source: Van Oosterom and Strackee 1983.
double winding_number(const std::vector<Triangle>& mesh, const LatticeVertex& point);

/// Signed volume in sub-voxels³, exact.
mpq_class volume(const std::vector<Triangle>& mesh);

}  // namespace gigabake::reference
