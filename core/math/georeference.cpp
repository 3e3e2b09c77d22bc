#include "core/math/georeference.h"

#include <GeographicLib/Geocentric.hpp>
#include <vector>

namespace gigabake {
namespace {

const GeographicLib::Geocentric& earth() { return GeographicLib::Geocentric::WGS84(); }

}  // namespace

bool is_on_earth(const Point<Ecef>& p, double radius_m) {
  constexpr double min_earth_radius_m = 6.35e6, max_radius_m = 3e6;
  if (!(radius_m <= max_radius_m)) radius_m = 0;  // a volume as large as this does not restrict its centre
  const double deepest_m = 12e3 + radius_m * radius_m / (2 * min_earth_radius_m);
  const double r = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  if (!(r > min_earth_radius_m - deepest_m && r < 6.6e6)) return false;
  const double height_m = geodetic_of(p).height_m;
  return height_m > -deepest_m && height_m < 100e3;
}

Geodetic geodetic_of(const Point<Ecef>& p) {
  Geodetic g;
  earth().Reverse(p.x, p.y, p.z, g.latitude_deg, g.longitude_deg, g.height_m);
  return g;
}

Point<Ecef> ecef_of(const Geodetic& g) {
  Point<Ecef> p;
  earth().Forward(g.latitude_deg, g.longitude_deg, g.height_m, p.x, p.y, p.z);
  return p;
}

Affine<Ecef, Scene> ecef_from_enu(const Geodetic& g) {
  std::vector<double> rotation(9);  // row-major, columns east, north, up
  Point<Ecef> p;
  earth().Forward(g.latitude_deg, g.longitude_deg, g.height_m, p.x, p.y, p.z, rotation);
  Affine<Ecef, Scene> r;
  const double t[3] = {p.x, p.y, p.z};
  for (std::size_t row = 0; row < 3; ++row)
    r.m[row] = {rotation[3 * row], rotation[3 * row + 1], rotation[3 * row + 2], t[row]};
  return r;
}

Affine<Scene, Ecef> scene_from_ecef(const Geodetic& origin) {
  const Affine<Ecef, Scene> back = ecef_from_enu(origin);
  Affine<Scene, Ecef> r;
  for (std::size_t row = 0; row < 3; ++row) {
    r.m[row][3] = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      r.m[row][c] = back.m[c][row];
      r.m[row][3] -= back.m[c][row] * back.m[c][3];
    }
  }
  return r;
}

}  // namespace gigabake
