/// The light of a picture: sun, sky, the air between, and what is behind everything.
#pragma once

#include <array>

#include "kernels/cast.h"
#include "kernels/cast_pixel.h"
#include "kernels/cast_shade.h"

namespace gigabake {

/// Mid-afternoon: the sun in the south-west, 42° high, and a blue sky. Flat ground keeps its own brightness.
kernels::CastLight afternoon_light();

/// Air that hides a tenth of what lies as far away as the scene is wide.
kernels::CastHaze air(const kernels::CastScene& scene);

/// What shows where no voxel does.
struct Background {
  bool sky = true;
  std::array<std::uint8_t, 4> rgba{};  ///< where not sky: sRGB, straight alpha
};

kernels::CastBackground to_cast(const Background& background);

}  // namespace gigabake
