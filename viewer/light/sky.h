/// Light of an image: sun, sky, air and background.
#pragma once

#include <array>

#include "kernels/light/lighting.h"
#include "kernels/marching/cast_camera.h"
#include "viewer/light/sun.h"

namespace gigabake {

/// Returns the light of sun and sky. The sun is whiter at higher elevations and dark below the horizon. The blue sky is
/// darker at dusk and nearly black if the sun is 18° below the horizon. In mid-afternoon (42° elevation) flat ground is
/// as bright as its albedo. A surface perpendicular to the sun's rays is then about 4/3 as bright as its albedo.
kernels::CastLight daylight(const SunDirection& sun);
/// Returns daylight() with the sun in the south-west at 42° elevation.
kernels::CastLight afternoon_light();

/// Angular radius of the sun's disc as seen from the earth.
inline constexpr double sun_radius_deg = 0.2665;

/// Returns the lighting of daylight(), in which surfaces occlude the sun and the sky. `part` selects the light that the
/// image shows. `radius_deg` is the angular radius of the sun. A larger sun casts softer shadows.
/// Range   radius_deg in (0, 30].
kernels::CastLighting lighting(const SunDirection& sun, kernels::CastLightPart part, const kernels::CastHaze& haze,
                               double radius_deg = sun_radius_deg);

/// Returns haze that transmits 1/20 of the light over a distance of visibility_m, the meteorological optical range. The
/// haze has the colour of the sky's horizon under `sun`.
/// Range   visibility_m > 0; infinity means clear air.
kernels::CastHaze air(double visibility_m, double voxel_size_m, const SunDirection& sun = {});

/// Returns the tone curve for screens. It is linear up to 0.6 (sRGB 203), a range that includes ground and trees.
/// Brighter light, such as white walls in the sun, is compressed to below 1. `stops` is the exposure; +1 doubles the
/// light.
kernels::CastTone screen_tone(double stops);

/// The background where no voxel is visible.
struct Background {
  bool sky = true;
  std::array<std::uint8_t, 4> rgba{};  ///< sRGB with straight alpha; used only without sky
};

kernels::CastBackground to_cast(const Background& background, const SunDirection& sun = {});

}  // namespace gigabake
