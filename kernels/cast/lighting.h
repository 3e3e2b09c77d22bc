/// What lights a picture in which surfaces stand in each other's light.
///
/// Space   Directions of the scene: x east, y north, z up.
/// Source  Keller and Heidrich 2001, "Interleaved Sampling"; Crassin et al. 2011, "Interactive Indirect Illumination
///         Using Voxel Cone Tracing".
#pragma once

#include <cstdint>

#include "kernels/cast/cast_camera.h"
#include "kernels/cast/shade.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// Pixels of a block of so many by so many look at different parts of the sun.
inline constexpr int sun_block = 4, sun_directions = sun_block * sun_block;
/// The same of the sky, at which every other pixel looks; what they see of it they share.
inline constexpr int sky_block = 8, sky_directions = sky_block * sky_block / 2;

/// What of the light is shown.
enum class CastLightPart : std::int32_t {
  all,
  sun,      ///< what the sun alone lights
  sky,      ///< what the sky alone lights, and the surface that stands before it
  shadow,   ///< how much of the sun a surface sees: white is all of it
  unhidden  ///< all of it, as if nothing stood in its way: no rays are cast to it
};

struct CastLighting {
  CastLight light;  ///< as if nothing stood in its way
  CastLightPart part = CastLightPart::all;
  CastHaze haze;                      ///< the camera's own must be none
  double sun_lod1 = 1;                ///< voxels from its tip at which the sun's cone is a voxel of lod 1 wide
  double sky_lod1 = 1;                ///< the same of the cones to the sky
  float sun[sun_directions][3] = {};  ///< unit, evenly over the sun's disc, by a pixel's place in its block
  float sky[sky_directions][3] = {};  ///< unit, evenly over the upper half, by a pixel's place in its block
};

}  // namespace gigabake::kernels
