/// The reference: triangle against voxel in exact rational arithmetic, written from docs/accuracy.md, not from
/// kernels/.
///
/// Space   Sub-voxels (1/256 voxel) from the lattice origin; voxel i is the half-open cube [256i, 256(i+1)).
/// Exact   GMP rationals; doubles appear only in the answers of area_voxel2() and Piece-to-double helpers.
/// Range   |coordinate| < 2^62.
#pragma once

#include <array>
#include <cstdint>
#include <gmpxx.h>
#include <set>
#include <vector>

#include "lattice/host_device.h"
#include "lattice/rules.h"

namespace gigabake::reference {

using Voxel = std::array<std::int64_t, 3>;
using LatticeVertex = std::array<std::int64_t, 3>;
using Triangle = std::array<LatticeVertex, 3>;
using RationalPoint = std::array<mpq_class, 3>;
using Polygon = std::vector<RationalPoint>;

/// A box of voxels: [min, min + edge) on each axis.
struct Window {
  Voxel min{};
  std::int64_t edge = 0;
};

/// The part of a closed triangle that lies in a closed voxel. Never empty; may be a point or a segment.
struct Piece {
  Voxel voxel{};
  Polygon polygon;
};

/// (v1-v0) × (v2-v0): twice the area vector, by the right hand.
std::array<mpz_class, 3> normal_of(const Triangle& t);

bool has_area(const Triangle& t);

/// Every closed voxel of the window that the closed triangle meets, with what it meets there.
std::vector<Piece> pieces_in(const Triangle& t, const Window& window);

/// Twice the area vector of a planar polygon, sub-voxels².
RationalPoint area_vector(const Polygon& polygon);

/// area(T ∩ half-open cube) > 0.
bool has_area_in_voxel(const Piece& piece);

/// T meets an axis segment through the centre, half-open like the voxel, of an axis that T is not parallel to.
bool crosses_centre_segment(const Triangle& t, const Voxel& voxel);

/// Those of its pieces' voxels that the rule says the triangle occupies. None for a triangle without area.
std::set<Voxel> occupied(const Triangle& t, const std::vector<Piece>& pieces, SurfaceRule rule);
std::set<Voxel> occupied(const Triangle& t, SurfaceRule rule, const Window& window);

/// Area in voxel², relative error below 1e-15 · 4. The triangle has area.
double area_voxel2(const Triangle& t);
double area_voxel2(const Piece& piece, const Triangle& t);

/// Barycentric coordinates, with respect to t, of the piece's centroid. The piece has area.
std::array<mpq_class, 3> centroid_barycentric(const Piece& piece, const Triangle& t);

}  // namespace gigabake::reference
