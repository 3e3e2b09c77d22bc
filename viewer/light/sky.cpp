#include "viewer/light/sky.h"

#include <cmath>
#include <numbers>

#include "kernels/body/tables.h"

namespace gigabake {
namespace {

constexpr std::array<float, 3> horizon{0.60f, 0.70f, 0.80f}, zenith{0.13f, 0.29f, 0.60f}, nadir{0.28f, 0.34f, 0.40f};
constexpr float knee = 0.6f;
constexpr double sun_azimuth_deg = 225, sun_elevation_deg = 42;

}  // namespace

kernels::CastLight afternoon_light() {
  const double degree = std::numbers::pi / 180;
  const double azimuth = sun_azimuth_deg * degree, elevation = sun_elevation_deg * degree;
  kernels::CastLight light;
  light.to_sun[0] = float(std::sin(azimuth) * std::cos(elevation));
  light.to_sun[1] = float(std::cos(azimuth) * std::cos(elevation));
  light.to_sun[2] = float(std::sin(elevation));
  const std::array<float, 3> sun{1.06f, 1.00f, 0.90f}, sky{0.30f, 0.35f, 0.44f}, ground{0.12f, 0.11f, 0.10f};
  for (int k = 0; k < 3; ++k) {
    light.sun[k] = sun[std::size_t(k)];
    light.sky[k] = sky[std::size_t(k)];
    light.ground[k] = ground[std::size_t(k)];
  }
  return light;
}

kernels::CastHaze air(double visibility_m, double voxel_size_m) {
  kernels::CastHaze haze;
  for (int k = 0; k < 3; ++k) haze.rgb[k] = horizon[std::size_t(k)];
  haze.per_voxel = float(std::log(20.0) * voxel_size_m / visibility_m);
  return haze;
}

kernels::CastTone screen_tone(double stops) { return {float(std::exp2(stops)), knee}; }

kernels::CastBackground to_cast(const Background& background) {
  kernels::CastBackground out;
  out.has_sky = background.sky;
  out.alpha = float(background.rgba[3]) / 255;
  const kernels::Tables tables = kernels::TableStore::host().view();
  for (std::size_t k = 0; k < 3; ++k) {
    out.sky.horizon[k] = horizon[k];
    out.sky.zenith[k] = zenith[k];
    out.sky.nadir[k] = nadir[k];
    out.rgb[k] = float(tables.linear_from_srgb[background.rgba[k]]) / 65535 * out.alpha;
  }
  return out;
}

}  // namespace gigabake
