#include "sample/terrain/earth.h"

#include <cmath>

namespace gigabake::sample {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double semi_major_m = 6378137.0;
constexpr double flattening = 1 / 298.257223563;
constexpr double e2 = flattening * (2 - flattening);

/// Returns sine and cosine of -45° to 45° by Taylor series: 11 terms leave an error below one ulp at 45°.
Turn octant(double degrees) {
  const double x = degrees * (pi / 180), square = x * x;
  double sine = 0, cosine = 0;
  for (int k = 11; k >= 1; --k) {
    sine = (1 - sine) * square / ((2 * k) * (2 * k + 1));
    cosine = (1 - cosine) * square / ((2 * k - 1) * (2 * k));
  }
  return {x * (1 - sine), 1 - cosine};
}

}  // namespace

Turn turn_of(double degrees) {
  const double quarter = std::floor(degrees / 90 + 0.5);
  const Turn t = octant(degrees - 90 * quarter);
  switch (static_cast<long long>(quarter) & 3) {
    case 0:
      return t;
    case 1:
      return {t.cosine, -t.sine};
    case 2:
      return {-t.sine, -t.cosine};
    default:
      return {-t.cosine, t.sine};
  }
}

Point<Ecef> ecef_of(const Geodetic& g) {
  const Turn lat = turn_of(g.latitude_deg), lon = turn_of(g.longitude_deg);
  const double prime_vertical = semi_major_m / std::sqrt(1 - e2 * lat.sine * lat.sine);
  const double across = (prime_vertical + g.height_m) * lat.cosine;
  return {across * lon.cosine, across * lon.sine, ((1 - e2) * prime_vertical + g.height_m) * lat.sine};
}

Earth::Earth(const Geodetic& origin) : origin_(origin) {
  const Turn lat = turn_of(origin.latitude_deg), lon = turn_of(origin.longitude_deg);
  const double w2 = 1 - e2 * lat.sine * lat.sine, w = std::sqrt(w2);
  const double meridian_m = semi_major_m * (1 - e2) / (w2 * w), prime_vertical_m = semi_major_m / w;
  degrees_north_per_m_ = 180 / pi / (meridian_m + origin.height_m);
  degrees_east_per_m_ = 180 / pi / ((prime_vertical_m + origin.height_m) * lat.cosine);
  const Point<Ecef> o = ecef_of(origin);
  ecef_from_enu_.m = {{{-lon.sine, -lat.sine * lon.cosine, lat.cosine * lon.cosine, o.x},
                       {lon.cosine, -lat.sine * lon.sine, lat.cosine * lon.sine, o.y},
                       {0, lat.cosine, lat.sine, o.z}}};
}

Geodetic Earth::geodetic(MapPoint p, double height_m) const {
  return {origin_.latitude_deg + p.n_m * degrees_north_per_m_, origin_.longitude_deg + p.e_m * degrees_east_per_m_,
          origin_.height_m + height_m};
}

Point<Enu> Earth::enu(MapPoint p, double height_m) const {
  const Point<Ecef> q = ecef_of(geodetic(p, height_m));
  const auto& m = ecef_from_enu_.m;
  const double dx = q.x - m[0][3], dy = q.y - m[1][3], dz = q.z - m[2][3];
  return {m[0][0] * dx + m[1][0] * dy + m[2][0] * dz, m[0][1] * dx + m[1][1] * dy + m[2][1] * dz,
          m[0][2] * dx + m[1][2] * dy + m[2][2] * dz};
}

}  // namespace gigabake::sample
