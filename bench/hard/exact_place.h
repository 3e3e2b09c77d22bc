/// The exact positions of a hard scene's vertices, computed from its files in long double and from closed forms. Uses
/// no code of format/ or kernels/, only plain vectors.
///
/// Exact   A long double has a mantissa of 64 bits on x86 and 113 bits on aarch64. This resolves 10⁻¹² m on the earth.
///         If the compiler's long double is a double, the suite compares double with double.
#pragma once

#include <vector>

#include "bench/hard/hard_scene.h"
#include "core/math/vec3.h"
#include "core/octree/parameters.h"

namespace gigabake::bench {

struct LongAffine {
  long double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  long double determinant() const;
};
using LongPoint = Vec3<long double>;

LongPoint operator*(const LongAffine& map, const LongPoint& p);
LongAffine operator*(const LongAffine& a, const LongAffine& b);

/// Returns the transform from ECEF to east, north, up at a place.
/// Source  The ellipsoid's normal form, WGS84; metres.
LongAffine enu_from_ecef(const Geodetic& origin);
/// Returns the inverse of enu_from_ecef().
LongAffine ecef_from_enu_at(const Geodetic& place);

/// Returns the transform from each node of each tile to the scene frame, in the order of the files. `origin` is the
/// origin of the scene frame if the scene is on the earth.
std::vector<LongAffine> exact_placements(const HardScene& scene, const std::optional<Geodetic>& origin);

/// Returns the position on the lattice before the snap, in sub-voxels.
LongPoint lattice_place(const BakeParameters& parameters, const LongPoint& p_scene_m);
/// Rounds each coordinate half up.
reference::LatticeVertex snapped(const LongPoint& p_lattice);

/// Returns every triangle instance of the scene on the lattice, with its material's constant colour. Omits triangles
/// that are not finite.
std::vector<reference::Painted> painted_triangles(const HardScene& scene, const std::optional<Geodetic>& origin,
                                                  const BakeParameters& parameters);

}  // namespace gigabake::bench
