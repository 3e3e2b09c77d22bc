#include "viewer/light/sky.h"

#include <cmath>
#include <iterator>
#include <numbers>

#include "kernels/body/tables.h"

namespace gigabake {
namespace {

constexpr std::array<float, 3> horizon{0.60f, 0.70f, 0.80f}, zenith{0.13f, 0.29f, 0.60f}, nadir{0.28f, 0.34f, 0.40f};
constexpr float knee = 0.6f;

/// The brightness of the sky at an elevation of the sun, relative to the brightness at 42°.
struct SkyBrightness {
  double elevation_deg;
  float share;
};
constexpr SkyBrightness sky_brightness[] = {{-18, 0.01f}, {-12, 0.03f}, {-6, 0.1f}, {0, 0.4f}, {15, 0.75f}, {42, 1}};

float share_of_sky(double elevation_deg) {
  const SkyBrightness* above = std::begin(sky_brightness);
  while (above != std::end(sky_brightness) && above->elevation_deg < elevation_deg) ++above;
  if (above == std::begin(sky_brightness)) return above->share;
  const SkyBrightness& below = above[-1];
  if (above == std::end(sky_brightness)) return below.share;
  const auto part = float((elevation_deg - below.elevation_deg) / (above->elevation_deg - below.elevation_deg));
  return below.share + (above->share - below.share) * part;
}

/// Returns the air mass relative to the zenith.
/// Source  Kasten and Young 1989.
double air_mass(double elevation_deg) {
  return 1 / (std::sin(elevation_deg * std::numbers::pi / 180) + 0.50572 * std::pow(elevation_deg + 6.07995, -1.6364));
}

/// Returns the transmitted red, green and blue sunlight, relative to the sunlight at the default elevation of 42°. The
/// constant `taken` holds the optical depths of clear air towards the zenith.
std::array<float, 3> share_of_sun(double elevation_deg) {
  if (elevation_deg <= 0) return {0, 0, 0};
  constexpr Vec3d taken{0.09, 0.16, 0.30};
  const double more = air_mass(elevation_deg) - air_mass(SunDirection{}.elevation_deg);
  std::array<float, 3> share;
  for (std::size_t k = 0; k < 3; ++k) share[k] = float(std::exp(-taken[k] * more));
  return share;
}

/// Distributes directions evenly over the upper hemisphere, in rings between equal steps of z. Pixels with consecutive
/// direction indices are far apart in a block, and their directions are mostly in the same or in adjacent rings. Each
/// half of the indices covers one half of the sky.
void set_sky_directions(Vec3<float> sky[kernels::sky_directions]) {
  constexpr int sides = 4, rings = kernels::sky_directions / sides;
  for (int n = 0; n < kernels::sky_directions; ++n) {
    const int half = n / (kernels::sky_directions / 2), in_half = n % (kernels::sky_directions / 2);
    const int ring = (in_half / 2 + rings / 2 * half) % rings;
    const int side = sides / 2 * half + in_half % 2;
    const double z = (ring + 0.5) / rings, level = std::sqrt(1 - z * z);
    const double turn = 2 * std::numbers::pi * (side + (ring * 3 % rings + 0.5) / rings) / sides;
    sky[n] = {float(std::cos(turn) * level), float(std::sin(turn) * level), float(z)};
  }
}

/// The distance in lod-0 voxels at which a cone to the sky is as wide as a lod-1 voxel. Wider cones overestimate
/// occlusion (docs/experiments/frames.md).
constexpr double sky_lod1 = 16;

/// Distributes directions evenly over the sun's disc, on a spiral from its edge inwards. The first directions, near the
/// edge, belong to the pixels whose rays are cast first. If these rays give equal results, rays to points between them
/// are assumed to give the same result.
///
/// Source  Vogel 1979, "A better way to construct the sunflower head".
void set_sun_directions(const SunDirection& sun, double radius_deg, Vec3<float> out[kernels::sun_directions]) {
  constexpr int points = kernels::sun_directions;
  const Vec3d east = to_sun({sun.azimuth_deg + 90, 0}), to = to_sun(sun);
  const Vec3d up = to_sun({sun.azimuth_deg + 180, 90 - sun.elevation_deg});
  for (int n = 0; n < points; ++n) {
    const double radius = std::tan(radius_deg * std::numbers::pi / 180) * std::sqrt((points - n - 0.5) / points);
    const double turn = n * std::numbers::pi * (3 - std::sqrt(5.0)), length = std::hypot(1, radius);
    for (std::size_t a = 0; a < 3; ++a)
      out[n][a] = float((to[a] + radius * (std::cos(turn) * east[a] + std::sin(turn) * up[a])) / length);
  }
}

}  // namespace

kernels::CastLight daylight(const SunDirection& sun) {
  const Vec3d to = to_sun(sun);
  const std::array<float, 3> of_sun = share_of_sun(sun.elevation_deg);
  const float of_sky = share_of_sky(sun.elevation_deg);
  const std::array<float, 3> rgb{1.06f, 1.00f, 0.90f}, sky{0.30f, 0.35f, 0.44f}, ground{0.12f, 0.11f, 0.10f};
  kernels::CastLight light;
  light.to_sun = static_cast<Vec3<float>>(to);
  for (std::size_t k = 0; k < 3; ++k) {
    light.sun[k] = rgb[k] * of_sun[k];
    light.sky[k] = sky[k] * of_sky;
    light.ground[k] = ground[k] * of_sky;
  }
  return light;
}

kernels::CastLight afternoon_light() { return daylight({}); }

kernels::CastLighting lighting(const SunDirection& sun, kernels::CastLightPart part, const kernels::CastHaze& haze,
                               double radius_deg) {
  kernels::CastLighting out;
  out.light = daylight(sun);
  out.part = part;
  out.haze = haze;
  out.sun_lod1 = 1 / std::tan(radius_deg * std::numbers::pi / 180);
  out.sky_lod1 = sky_lod1;
  set_sun_directions(sun, radius_deg, out.sun);
  set_sky_directions(out.sky);
  return out;
}

kernels::CastHaze air(double visibility_m, double voxel_size_m, const SunDirection& sun) {
  kernels::CastHaze haze;
  for (std::size_t k = 0; k < 3; ++k) haze.rgb[k] = horizon[k] * share_of_sky(sun.elevation_deg);
  haze.per_voxel = float(std::log(20.0) * voxel_size_m / visibility_m);
  return haze;
}

kernels::CastTone screen_tone(double stops) { return {float(std::exp2(stops)), knee}; }

kernels::CastBackground to_cast(const Background& background, const SunDirection& sun) {
  const float of_sky = share_of_sky(sun.elevation_deg);
  kernels::CastBackground out;
  out.has_sky = background.sky;
  out.alpha = float(background.rgba[3]) / 255;
  const kernels::Tables tables = kernels::TableStore::host().view();
  for (std::size_t k = 0; k < 3; ++k) {
    out.sky.horizon[k] = horizon[k] * of_sky;
    out.sky.zenith[k] = zenith[k] * of_sky;
    out.sky.nadir[k] = nadir[k] * of_sky;
    out.rgb[k] = float(tables.linear_from_srgb[background.rgba[k]]) / 65535 * out.alpha;
  }
  return out;
}

}  // namespace gigabake
