/// The sample's map on the WGS84 earth.
///
/// Map    Metres east and north on the sample's map, height in metres above the map's origin. Straight and flat.
/// Enu    East-north-up metres, a plane tangent to the ellipsoid at the map's origin; georeferenced tiles stand in it.
#pragma once

#include <array>

#include "lattice/frames.h"

namespace gigabake::sample {

struct MapPoint {
  double e_m = 0, n_m = 0;
};

/// So many steps east and north.
struct GridSize {
  int e = 1, n = 1;
};

struct Enu;

/// Sine and cosine of an angle in degrees.
/// Exact   IEEE double, no libm: the same bits on every machine. Within 2e-16 of the true value.
/// Range   |degrees| ≤ 1e6.
struct Turn {
  double sine = 0, cosine = 1;
};
Turn turn_of(double degrees);

/// How the flat map lies on the earth: metres north become degrees of latitude, metres east degrees of longitude at
/// the radii of curvature of the origin; height is kept as height above the ellipsoid.
class Earth {
 public:
  explicit Earth(const Geodetic& origin);
  /// The map's point in the tangent frame of the origin: the ground falls away with the earth's curvature.
  Point<Enu> enu(MapPoint p, double height_m) const;
  Geodetic geodetic(MapPoint p, double height_m) const;
  const Affine<Ecef, Enu>& ecef_from_enu() const { return ecef_from_enu_; }

 private:
  Geodetic origin_;
  double degrees_north_per_m_ = 0, degrees_east_per_m_ = 0;
  Affine<Ecef, Enu> ecef_from_enu_;
};

/// Geodetic to earth-centred metres on WGS84.
Point<Ecef> ecef_of(const Geodetic& g);

}  // namespace gigabake::sample
