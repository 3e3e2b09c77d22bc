/// The colour of the sample's ground.
#pragma once

#include "sample/settlement/picture.h"
#include "sample/settlement/settlement.h"

namespace gigabake::sample {

/// Returns the sRGB colour of the ground at p: water, banks, meadows, fields, woodland floor, scree and rock, roads.
Rgb ground_colour(const Relief& relief, const Settlement& settlement, std::uint32_t seed, MapPoint p);

/// Paints the ground, north up. Texel centres are at half steps, so that neighbouring images continue each other.
Picture paint_ground(const Relief& relief, const Settlement& settlement, std::uint32_t seed, MapPoint min,
                     MapPoint size_m, GridSize texels);

}  // namespace gigabake::sample
