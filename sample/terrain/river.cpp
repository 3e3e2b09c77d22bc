#include "sample/terrain/river.h"

#include <algorithm>
#include <cmath>

#include "sample/terrain/noise.h"

namespace gigabake::sample {
namespace {

constexpr int station_count = 4096;
constexpr double fall_per_m = 0.004;
/// Direction of the valley: (1, 3) / √10, about north-north-east.
const double axis_e = 1 / std::sqrt(10.0), axis_n = 3 / std::sqrt(10.0);

}  // namespace

River::River(double size_m, double relief_m, std::uint32_t seed)
    : seed_(seed), first_m_(-size_m), step_m_(2 * size_m / (station_count - 1)), relief_m_(relief_m) {
  const double half_width_m = std::clamp(0.009 * relief_m, 2.5, 25.0);
  const double lake_along_m = -0.2 * relief_m, lake_half_length_m = 0.17 * relief_m,
               lake_half_width_m = 0.06 * relief_m;
  double level_m = 0;
  for (int i = 0; i < station_count; ++i) {
    const double s = first_m_ + i * step_m_, q = s / relief_m;
    const double lake = 1 - smooth_step(0.25, 1.0, std::fabs(s - lake_along_m) / lake_half_length_m);
    Station station;
    station.across_m = relief_m * (0.24 * noise(seed, 1.1 * q, 0.5) + 0.07 * noise(seed + 1, 3.7 * q, 0.5) - 0.03);
    station.half_width_m = half_width_m * (1 + 0.5 * noise(seed + 2, 9 * q, 0.5)) + lake_half_width_m * lake;
    // The lake is level from end to end; elsewhere the water falls.
    if (std::fabs(s - lake_along_m) > lake_half_length_m) level_m -= fall_per_m * step_m_;
    station.level_m = level_m;
    stations_.push_back(station);
  }
  const double middle_m = this->station(0).level_m;
  for (Station& station : stations_) station.level_m -= middle_m;
}

River::Station River::station(double along_m) const {
  const double g = std::clamp((along_m - first_m_) / step_m_, 0.0, station_count - 1.001);
  const int i = int(g);
  const Station &a = stations_[i], &b = stations_[i + 1];
  const double t = g - i;
  return {lerp(a.across_m, b.across_m, t), lerp(a.half_width_m, b.half_width_m, t), lerp(a.level_m, b.level_m, t)};
}

Reach River::at(MapPoint p) const {
  const double along_m = p.e_m * axis_e + p.n_m * axis_n, across_m = p.e_m * axis_n - p.n_m * axis_e;
  const Station here = station(along_m);
  const double span_m = 8 * step_m_;
  const double bend = (station(along_m + span_m).across_m - station(along_m - span_m).across_m) / (2 * span_m);
  const double offset_m = across_m - here.across_m;
  const double to_middle_m = std::fabs(offset_m) / std::sqrt(1 + bend * bend);
  const double wobble_m = 0.35 * here.half_width_m * noise(seed_ + 3, p.e_m * 16 / relief_m_, p.n_m * 16 / relief_m_);
  return {to_middle_m - here.half_width_m + wobble_m, here.level_m, along_m, offset_m < 0};
}

MapPoint River::beside(double along_m, double across_m) const {
  const double t = station(along_m).across_m + across_m;
  return {along_m * axis_e + t * axis_n, along_m * axis_n - t * axis_e};
}

}  // namespace gigabake::sample
