#include "sample/terrain/relief.h"

#include <algorithm>
#include <cmath>

#include "sample/terrain/erosion.h"
#include "sample/terrain/noise.h"

namespace gigabake::sample {
namespace {

/// The grid's size relative to the map. The grid extends beyond the map's border, so that the border has neighbours to
/// drain to.
constexpr double margin = 1.12;
constexpr double bank_m = 0.7;  ///< height of the meadows above the water

int grid_points(double size_m) {
  return 1 + int(std::clamp(size_m * margin / 3.5, 128.0, size_m > 3000 ? 512.0 : 320.0));
}

double relief_length_m(double size_m) { return std::clamp(size_m, 150.0, 4000.0); }

}  // namespace

Relief::Relief(double size_m, std::uint32_t seed)
    : size_m_(size_m),
      relief_m_(relief_length_m(size_m)),
      seed_(seed),
      river_(size_m, relief_m_, hash_of(seed, 1)),
      ground_(grid_points(size_m), -size_m * margin / 2, size_m * margin / 2),
      slope_(ground_),
      moisture_(ground_),
      hollowness_(ground_) {
  shape();
}

void Relief::shape() {
  Raster uplift_m = ground_;
  std::vector<std::uint8_t> base(ground_.v.size(), 0);
  for (int y = 0; y < ground_.edge; ++y)
    for (int x = 0; x < ground_.edge; ++x) {
      const MapPoint p = ground_.point(x, y);
      const Reach reach = river_.at(p);
      const double warp_e = 0.16 * noise(seed_ + 10, 1.7 * p.e_m / relief_m_, 1.7 * p.n_m / relief_m_);
      const double warp_n = 0.16 * noise(seed_ + 11, 1.7 * p.e_m / relief_m_, 1.7 * p.n_m / relief_m_);
      const double u = p.e_m / relief_m_ + warp_e, v = p.n_m / relief_m_ + warp_n;
      const double floor_m = relief_m_ * (0.10 + 0.14 * noise(seed_ + 12, 1.3 * reach.along_m / relief_m_, reach.west));
      const double hill = smooth_step(0, relief_m_ * 0.42, reach.shore_m - floor_m);
      const double crest = 0.35 + 0.5 * ridged_noise(seed_ + 13, 1.5 * u, 1.5 * v, 4) + 0.5 * noise(seed_ + 14, u, v);
      const double rise_m = relief_m_ * (reach.west ? 0.17 : 0.13) * hill * std::max(0.12, crest);
      ground_.at(x, y) = reach.level_m + bank_m + 0.010 * std::max(0.0, reach.shore_m) + 0.35 * rise_m +
                         0.06 * relief_m_ * hill * fractal_noise(seed_ + 15, 5 * u, 5 * v, 5);
      uplift_m.at(x, y) = 0.9 * rise_m;
      base[std::size_t(y) * ground_.edge + x] = reach.shore_m < ground_.cell_m;
    }
  ErosionOptions erosion;
  erosion.gully_m2 = 0.0006 * relief_m_ * relief_m_;
  measure(erode(ground_, uplift_m, base, erosion));
}

void Relief::measure(const Raster& drained_area) {
  const int edge = ground_.edge;
  const auto cell = [&](int x, int y) { return ground_.at(std::clamp(x, 0, edge - 1), std::clamp(y, 0, edge - 1)); };
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) {
      const double de = (cell(x + 1, y) - cell(x - 1, y)) / (2 * ground_.cell_m);
      const double dn = (cell(x, y + 1) - cell(x, y - 1)) / (2 * ground_.cell_m);
      slope_.at(x, y) = std::sqrt(de * de + dn * dn);
      const double around = (cell(x - 2, y) + cell(x + 2, y) + cell(x, y - 2) + cell(x, y + 2)) / 4;
      hollowness_.at(x, y) = std::clamp((around - cell(x, y)) / ground_.cell_m, -1.0, 1.0);
      // The fourth root maps areas of 10 m² to 1 km² to an even scale.
      moisture_.at(x, y) = clamp01((std::sqrt(std::sqrt(drained_area.at(x, y))) / std::sqrt(ground_.cell_m) - 1) / 9);
    }
}

double Relief::slope(MapPoint p) const { return slope_.linear(p); }

double Relief::shaped_height_m(MapPoint p) const {
  const double rough = smooth_step(0.06, 0.5, slope(p));
  const double detail_m = (0.25 + 2.2 * rough) * fractal_noise(seed_ + 20, p.e_m / 14, p.n_m / 14, 3);
  return ground_.cubic(p) + detail_m;
}

double Relief::height_m(MapPoint p) const {
  const Reach reach = river_.at(p);
  if (reach.shore_m <= 0) return reach.level_m;
  // The bank rises from the water's edge. No dry ground lies below the level of the adjacent water.
  const double bank = smooth_step(0, 4, reach.shore_m);
  return reach.level_m + bank * std::max(0.3, shaped_height_m(p) - reach.level_m);
}

}  // namespace gigabake::sample
