#include "format/source/tiles/tileset_anchor.h"

#include <cmath>
#include <numbers>

#include "core/math/georeference.h"
#include "core/math/transform.h"
#include "format/system/json/json_members.h"

namespace gigabake {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

/// Returns the centre of a region. If the region crosses the antimeridian, west is greater than east.
Point<Ecef> region_centre(const JsonMembers& volume, const std::array<double, 6>& region) {
  const double west = region[0], south = region[1], north = region[3];
  double east = region[2];
  constexpr double slack = 1e-6, quarter = std::numbers::pi / 2 + slack, half = std::numbers::pi + slack;
  if (std::fabs(south) > quarter || std::fabs(north) > quarter || std::fabs(west) > half || std::fabs(east) > half)
    volume.fail("region", "expected longitudes within ±π and latitudes within ±π/2");
  if (west > east) east += 2 * std::numbers::pi;
  return ecef_of(
      {(south + north) / 2 * degrees, std::remainder((west + east) / 2 * degrees, 360), (region[4] + region[5]) / 2});
}

struct Ball {
  Point<Ecef> centre;
  double radius_m;
};

std::optional<Ball> bounding_ball(const JsonMembers& volume, const Affine<Ecef, World>& ecef_from_root) {
  if (const auto b = volume.numbers<12>("box")) {
    double sum = 0;
    for (std::size_t i = 3; i < 12; ++i) sum += (*b)[i] * (*b)[i];
    return Ball{ecef_from_root({(*b)[0], (*b)[1], (*b)[2]}), std::sqrt(sum)};
  }
  if (const auto s = volume.numbers<4>("sphere"))
    return Ball{ecef_from_root({(*s)[0], (*s)[1], (*s)[2]}), std::fabs((*s)[3])};
  return std::nullopt;
}

}  // namespace

std::optional<Point<Ecef>> tileset_anchor(const std::filesystem::path& file, const Json& root) {
  const JsonMembers members(file, root, "root");
  const auto transform = members.numbers<16>("transform");
  const auto ecef_from_root = transform ? affine_from_columns<Ecef, World>(*transform) : Affine<Ecef, World>();
  const JsonMembers volume = members.members("boundingVolume");
  const auto region = volume.numbers<6>("region");
  const auto ball = bounding_ball(volume, ecef_from_root);
  const Point<Ecef> origin = ecef_from_root({0, 0, 0});
  if (is_on_earth(origin)) return origin;
  if (region) return region_centre(volume, *region);
  if (ball && is_on_earth(ball->centre, ball->radius_m)) return ball->centre;
  return std::nullopt;
}

}  // namespace gigabake
