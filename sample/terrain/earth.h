/// The sample's map on the WGS84 earth.
///
/// Space   Map: metres east and north on the sample's map, height in metres above the map's origin; rectangular and
///         flat.
/// Space   Enu: east-north-up metres, in the plane tangent to the ellipsoid at the map's origin; the frame of
///         georeferenced tiles.
#pragma once

#include <array>

#include "core/math/frames.h"

namespace gigabake::sample {

struct MapPoint {
  double e_m = 0, n_m = 0;
};

/// Number of steps east and north.
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

/// Projection of the flat map onto the earth. Metres north become degrees of latitude, and metres east become degrees
/// of longitude, both with the radii of curvature at the origin. Heights become heights above the ellipsoid.
class Earth {
 public:
  explicit Earth(const Geodetic& origin);
  /// Returns the point in the origin's tangent frame; distant points are lower, due to the earth's curvature.
  Point<Enu> enu(MapPoint p, double height_m) const;
  Geodetic geodetic(MapPoint p, double height_m) const;
  const Affine<Ecef, Enu>& ecef_from_enu() const { return ecef_from_enu_; }

 private:
  Geodetic origin_;
  double degrees_north_per_m_ = 0, degrees_east_per_m_ = 0;
  Affine<Ecef, Enu> ecef_from_enu_;
};

/// Converts geodetic coordinates to earth-centred metres on WGS84.
Point<Ecef> ecef_of(const Geodetic& g);

}  // namespace gigabake::sample
