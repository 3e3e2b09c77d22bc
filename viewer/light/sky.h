/// The light of a picture: sun, sky, the air between, and what is behind everything.
#pragma once

#include <array>

#include "kernels/cast/cast.h"
#include "kernels/cast/lighting.h"
#include "kernels/cast/pixel.h"
#include "kernels/cast/shade.h"
#include "viewer/light/sun.h"

namespace gigabake {

/// The sun, whiter the higher it stands, and a blue sky, which is darker by dusk and nearly black when the sun is 18°
/// below the horizon; below it there is no sun. Mid-afternoon, 42° high, flat ground keeps its own brightness; a white
/// wall that faces the sun is a third brighter than 1.
kernels::CastLight daylight(const SunDirection& sun);
/// daylight() of the sun in the south-west, 42° high.
kernels::CastLight afternoon_light();

/// The sun's disc from the earth: half of its angle.
inline constexpr double sun_radius_deg = 0.2665;

/// That light where surfaces stand in it. radius_deg: what makes shadows soft. Range  above 0, at most 30.
kernels::CastLighting lighting(const SunDirection& sun, kernels::CastLightPart part, const kernels::CastHaze& haze,
                               double radius_deg = sun_radius_deg);

/// Air that leaves a twentieth of what lies visibility_m away (the meteorological optical range). Range  > 0; infinity:
/// clear. As bright as the sky is with that sun.
kernels::CastHaze air(double visibility_m, double voxel_size_m, const SunDirection& sun = {});

/// How a screen shows that light: as it is up to 0.6, sRGB 203, which is all that ground and trees are; what is
/// brighter, as white walls in the sun, is bent below 1 instead of cut off. stops: 1 doubles the light.
kernels::CastTone screen_tone(double stops);

/// What shows where no voxel does.
struct Background {
  bool sky = true;
  std::array<std::uint8_t, 4> rgba{};  ///< where not sky: sRGB, straight alpha
};

kernels::CastBackground to_cast(const Background& background, const SunDirection& sun = {});

}  // namespace gigabake
