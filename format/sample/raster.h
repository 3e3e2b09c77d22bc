/// A grid of numbers over the map, read between its points.
#pragma once

#include <vector>

#include "format/sample/earth.h"

namespace gigabake::sample {

struct Raster {
  int edge = 0;           ///< points along each side
  double min_m = 0;       ///< map coordinate, east and north alike, of the first point
  double cell_m = 1;      ///< from one point to the next
  std::vector<double> v;  ///< edge · edge, rows run east, the first row is the southernmost

  Raster(int points, double low_m, double high_m)
      : edge(points), min_m(low_m), cell_m((high_m - low_m) / (points - 1)), v(std::size_t(points) * points, 0.0) {}

  double& at(int x, int y) { return v[std::size_t(y) * edge + x]; }
  double at(int x, int y) const { return v[std::size_t(y) * edge + x]; }
  MapPoint point(int x, int y) const { return {min_m + x * cell_m, min_m + y * cell_m}; }

  /// Bilinear; beyond the rim the rim's value.
  double linear(MapPoint p) const;
  /// Uniform cubic B-spline: twice continuously differentiable, smooths a little.
  double cubic(MapPoint p) const;
};

}  // namespace gigabake::sample
