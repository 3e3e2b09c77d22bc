/// A grid of numbers over the map, with interpolation.
#pragma once

#include <vector>

#include "sample/terrain/earth.h"

namespace gigabake::sample {

struct Raster {
  int edge = 0;           ///< points along each side
  double min_m = 0;       ///< map coordinate of the first point, both east and north
  double cell_m = 1;      ///< distance between points
  std::vector<double> v;  ///< edge · edge; rows run east; the first row is the southernmost

  Raster(int points, double low_m, double high_m)
      : edge(points), min_m(low_m), cell_m((high_m - low_m) / (points - 1)), v(std::size_t(points) * points, 0.0) {}

  double& at(int x, int y) { return v[std::size_t(y) * edge + x]; }
  double at(int x, int y) const { return v[std::size_t(y) * edge + x]; }
  MapPoint point(int x, int y) const { return {min_m + x * cell_m, min_m + y * cell_m}; }

  /// Interpolates bilinearly; outside of the grid, returns the border's value.
  double linear(MapPoint p) const;
  /// Interpolates by a uniform cubic B-spline: twice continuously differentiable, slightly smoothing.
  double cubic(MapPoint p) const;
};

}  // namespace gigabake::sample
