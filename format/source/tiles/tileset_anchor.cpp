#include "format/source/tiles/tileset_anchor.h"

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/math/transform.h"

namespace gigabake {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr const char* volume_key = "root.boundingVolume";

/// Returns the centre of a region, which may cross the antimeridian (then west > east).
Point<Ecef> region_centre(const std::filesystem::path& file, const std::vector<double>& region) {
  const double west = region[0], south = region[1], north = region[3];
  double east = region[2];
  constexpr double slack = 1e-6, quarter = std::numbers::pi / 2 + slack, half = std::numbers::pi + slack;
  if (std::fabs(south) > quarter || std::fabs(north) > quarter || std::fabs(west) > half || std::fabs(east) > half)
    throw InputError(file, std::string(volume_key) + ".region",
                     "expected longitudes within ±π and latitudes within ±π/2");
  if (west > east) east += 2 * std::numbers::pi;
  return ecef_of(
      {(south + north) / 2 * degrees, std::remainder((west + east) / 2 * degrees, 360), (region[4] + region[5]) / 2});
}

struct Ball {
  Point<Ecef> centre;
  double radius_m;
};

std::optional<Ball> bounding_ball(const std::filesystem::path& file, const Json& volume,
                                  const Affine<Ecef, World>& ecef_from_root) {
  if (const auto b = get_numbers(file, volume, volume_key, "box", 12)) {
    double sum = 0;
    for (std::size_t i = 3; i < 12; ++i) sum += (*b)[i] * (*b)[i];
    return Ball{ecef_from_root({(*b)[0], (*b)[1], (*b)[2]}), std::sqrt(sum)};
  }
  if (const auto s = get_numbers(file, volume, volume_key, "sphere", 4))
    return Ball{ecef_from_root({(*s)[0], (*s)[1], (*s)[2]}), std::fabs((*s)[3])};
  return std::nullopt;
}

}  // namespace

std::optional<Point<Ecef>> tileset_anchor(const std::filesystem::path& file, const Json& root) {
  const auto transform = get_numbers(file, root, "root", "transform", 16);
  const auto ecef_from_root = transform ? affine_from_columns<Ecef, World>(*transform) : Affine<Ecef, World>();
  const Json& volume = get_object(file, root, "root", "boundingVolume");
  const auto region = get_numbers(file, volume, volume_key, "region", 6);
  const auto ball = bounding_ball(file, volume, ecef_from_root);
  const Point<Ecef> origin = ecef_from_root({0, 0, 0});
  if (is_on_earth(origin)) return origin;
  if (region) return region_centre(file, *region);
  if (ball && is_on_earth(ball->centre, ball->radius_m)) return ball->centre;
  return std::nullopt;
}

}  // namespace gigabake
