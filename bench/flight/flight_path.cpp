#include "bench/flight/flight_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gigabake::bench {
namespace {

constexpr double radius = 0.4, min_height = 0.05, height_range = 0.1;
constexpr int waves = 3;         ///< times that the height rises and falls per orbit
constexpr int pieces = 1 << 20;  ///< pieces of the orbit whose lengths are added

double height_at(double angle) { return min_height + height_range * (1 + std::cos(waves * angle)); }

/// Returns the length of the orbit per radian at an angle.
double length_per_radian(const FlightArea& area, double angle) {
  return area.width_m * std::hypot(radius, height_range * waves * std::sin(waves * angle));
}

/// Calls `visit(angle, length)` for each piece, with its end and the length of the orbit up to there.
template <class Visit>
void measure_orbit(const FlightArea& area, const Visit& visit) {
  constexpr double piece = 2 * std::numbers::pi / pieces;
  double length_m = 0;
  for (int i = 0; i < pieces; ++i) {
    length_m += piece * length_per_radian(area, (i + 0.5) * piece);
    visit((i + 1) * piece, length_m);
  }
}

}  // namespace

View view_from(const Point<Scene>& eye_m, const Point<Scene>& target_m, int width, int height) {
  View view;
  view.camera.eye_m = eye_m;
  view.camera.target_m = target_m;
  view.camera.width = width;
  view.camera.height = height;
  return view;
}

View orbit_view(const FlightArea& area, double angle, int width, int height) {
  const double w = area.width_m;
  const auto around = [&](double of_width, double at, double up) {
    return Point<Scene>{area.middle_m.x + of_width * w * std::cos(at), area.middle_m.y + of_width * w * std::sin(at),
                        area.ground_m + up * w};
  };
  return view_from(around(radius, angle, height_at(angle)), around(radius / 2, angle + 1, 0), width, height);
}

double orbit_length_m(const FlightArea& area) {
  double length = 0;
  measure_orbit(area, [&](double, double length_m) { length = length_m; });
  return length;
}

std::vector<double> orbit_angles(const FlightArea& area, double step_m) {
  std::vector<double> angles{0};
  measure_orbit(area, [&](double angle, double length_m) {
    if (length_m >= double(angles.size()) * step_m && angle < 2 * std::numbers::pi) angles.push_back(angle);
  });
  return angles;
}

}  // namespace gigabake::bench
