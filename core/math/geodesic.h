/// Distances along lines on the WGS84 ellipsoid.
#pragma once

#include <vector>

#include "core/math/frames.h"

namespace gigabake {

/// A line of vertices on the ellipsoid. Its edges are geodesics, the shortest lines between two vertices.
/// Source  Karney 2013, "Algorithms for geodesics", by GeographicLib: distances are right to 15 nm.
class GeodesicPath {
 public:
  /// Ignores the heights of the vertices.
  /// Range   At least two vertices, with latitudes within ±90 degrees.
  explicit GeodesicPath(const std::vector<Geodetic>& vertices);

  double length_m() const { return length_m_; }
  /// Returns the position at a distance from the first vertex, with height 0 and a longitude within ±180 degrees.
  /// Range   0 ≤ distance_m ≤ length_m().
  Geodetic position(double distance_m) const;

 private:
  struct Edge {
    double latitude_deg, longitude_deg, azimuth_deg;
    double begin_m;  ///< distance of its first vertex along the path
  };
  std::vector<Edge> edges_;
  double length_m_ = 0;
};

}  // namespace gigabake
