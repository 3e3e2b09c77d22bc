/// The reference for intersections of triangles and voxels, in exact rational arithmetic. It is written from
/// docs/accuracy.md, not from kernels/, and shares only Vec3 with them.
///
/// Space   Sub-voxels (1/256 voxel) from the lattice origin; voxel i is the half-open cube [256i, 256(i+1)).
/// Exact   GMP rationals. Only area_voxel2() and the conversions of a Piece to double return doubles.
/// Range   |coordinate| < 2^62.
#pragma once

#include <array>
#include <cstdint>
#include <gmpxx.h>
#include <set>
#include <vector>

#include "core/base/rules.h"
#include "core/math/vec3.h"

namespace gigabake::reference {

using Voxel = Vec3i64;
using LatticeVertex = Vec3i64;
using Triangle = std::array<LatticeVertex, 3>;
using RationalPoint = std::array<mpq_class, 3>;
using Polygon = std::vector<RationalPoint>;

/// A box of voxels: [min, min + edge) on each axis.
struct Window {
  Voxel min{};
  std::int64_t edge = 0;
};

/// The part of a closed triangle that lies in a closed voxel. The polygon is never empty, but may be a point or a
/// segment.
struct Piece {
  Voxel voxel{};
  Polygon polygon;
};

/// Returns (v1-v0) × (v2-v0): twice the area vector, right-handed.
std::array<mpz_class, 3> normal_of(const Triangle& t);

bool has_area(const Triangle& t);

/// Returns the intersection of the closed triangle with each closed voxel of the window that it intersects.
std::vector<Piece> pieces_in(const Triangle& t, const Window& window);

/// Returns twice the area vector of a planar polygon, in sub-voxels².
RationalPoint area_vector(const Polygon& polygon);

/// Returns true if the triangle has area in the half-open voxel of the piece.
bool has_area_in_voxel(const Piece& piece);

/// Returns true if the triangle crosses one of three segments through the voxel's centre, which are parallel to the
/// axes. A segment is ignored if it is parallel to the triangle's plane. Segments end at the voxel's faces and are
/// half-open like the voxel.
bool crosses_centre_segment(const Triangle& t, const Voxel& voxel);

/// Returns those voxels of the pieces, or of the window, that the triangle occupies by the rule. Returns no voxels for
/// a triangle without area.
std::set<Voxel> occupied(const Triangle& t, const std::vector<Piece>& pieces, SurfaceRule rule);
std::set<Voxel> occupied(const Triangle& t, SurfaceRule rule, const Window& window);

/// Returns the area in voxel².
/// Exact   Relative error below 4e-15.
/// Range   The triangle has area.
double area_voxel2(const Triangle& t);
double area_voxel2(const Piece& piece, const Triangle& t);

/// Returns the barycentric coordinates of the piece's centroid with respect to t.
/// Range   The piece has area.
std::array<mpq_class, 3> centroid_barycentric(const Piece& piece, const Triangle& t);

}  // namespace gigabake::reference
