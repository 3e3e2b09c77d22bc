/// The light of a picture: sun, sky, the air between, and what is behind everything.
#pragma once

#include <array>

#include "kernels/cast/cast.h"
#include "kernels/cast/pixel.h"
#include "kernels/cast/shade.h"

namespace gigabake {

/// Mid-afternoon: the sun in the south-west, 42° high, and a blue sky. Flat ground keeps its own brightness; a white
/// wall that faces the sun is a third brighter than 1.
kernels::CastLight afternoon_light();

/// Air that leaves a twentieth of what lies visibility_m away (the meteorological optical range). Range  > 0; infinity:
/// clear.
kernels::CastHaze air(double visibility_m, double voxel_size_m);

/// How a screen shows that light: as it is up to 0.6, sRGB 203, which is all that ground and trees are; what is
/// brighter, as white walls in the sun, is bent below 1 instead of cut off. stops: 1 doubles the light.
kernels::CastTone screen_tone(double stops);

/// What shows where no voxel does.
struct Background {
  bool sky = true;
  std::array<std::uint8_t, 4> rgba{};  ///< where not sky: sRGB, straight alpha
};

kernels::CastBackground to_cast(const Background& background);

}  // namespace gigabake
