#include "sample/terrain/raster.h"

#include <algorithm>
#include <cmath>

#include "sample/terrain/noise.h"

namespace gigabake::sample {
namespace {

struct GridPosition {
  int index;
  double fraction;
};

GridPosition locate(const Raster& r, double coordinate_m) {
  const double g = std::clamp((coordinate_m - r.min_m) / r.cell_m, 0.0, double(r.edge - 1));
  const int i = std::min(int(g), r.edge - 2);
  return {i, g - i};
}

void spline_weights(double t, double w[4]) {
  const double s = 1 - t;
  w[0] = s * s * s / 6;
  w[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
  w[2] = (3 * s * s * s - 6 * s * s + 4) / 6;
  w[3] = t * t * t / 6;
}

}  // namespace

double Raster::linear(MapPoint p) const {
  const GridPosition x = locate(*this, p.e_m), y = locate(*this, p.n_m);
  const double low = lerp(at(x.index, y.index), at(x.index + 1, y.index), x.fraction);
  const double high = lerp(at(x.index, y.index + 1), at(x.index + 1, y.index + 1), x.fraction);
  return lerp(low, high, y.fraction);
}

double Raster::cubic(MapPoint p) const {
  const GridPosition x = locate(*this, p.e_m), y = locate(*this, p.n_m);
  double wx[4], wy[4], sum = 0;
  spline_weights(x.fraction, wx);
  spline_weights(y.fraction, wy);
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(y.index + j - 1, 0, edge - 1);
    for (int i = 0; i < 4; ++i) sum += wy[j] * wx[i] * at(std::clamp(x.index + i - 1, 0, edge - 1), row);
  }
  return sum;
}

}  // namespace gigabake::sample
