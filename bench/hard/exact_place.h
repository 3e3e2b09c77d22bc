/// Where the vertices of a hard scene are, computed from what its files say in long double and from closed forms: no
/// code of format/ or kernels/.
///
/// Exact   64 bits of mantissa on x86, 113 on aarch64: 10⁻¹² m on the earth. Where a compiler's long double is a double
///         the suite says what double says twice.
#pragma once

#include <vector>

#include "bench/hard/hard_scene.h"
#include "lattice/parameters.h"

namespace gigabake::bench {

struct LongAffine {
  long double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  long double determinant() const;
};
using LongPoint = std::array<long double, 3>;

LongPoint operator*(const LongAffine& map, const LongPoint& p);
LongAffine operator*(const LongAffine& a, const LongAffine& b);

/// East, north and up at a place, from ECEF. Source  the ellipsoid's normal form, WGS84; metres.
LongAffine enu_from_ecef(const Geodetic& origin);
/// Its inverse.
LongAffine ecef_from_enu_at(const Geodetic& place);

/// Of each node of each tile, in the order of the files. origin: where the scene frame stands, if it is on the earth.
std::vector<LongAffine> exact_placements(const HardScene& scene, const std::optional<Geodetic>& origin);

/// Sub-voxels before the snap.
LongPoint lattice_place(const BakeParameters& parameters, const LongPoint& p_scene_m);
/// Half up.
reference::LatticeVertex snapped(const LongPoint& p_lattice);

/// Every triangle of the scene on the lattice, as its instance shows it, with its material's plain colour. Left out:
/// triangles that are not finite.
std::vector<reference::Painted> painted_triangles(const HardScene& scene, const std::optional<Geodetic>& origin,
                                                  const BakeParameters& parameters);

}  // namespace gigabake::bench
