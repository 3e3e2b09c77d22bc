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

/// Pixels of a block of so many by so many look at different parts of the sun and of the sky, at so many of the sky
/// each; what they see of the sky they share.
inline constexpr int light_block = 4, sky_rays = 2;
inline constexpr int sky_directions = light_block * light_block * sky_rays;

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
  CastHaze haze;        ///< the camera's own must be none
  double sun_lod1 = 1;  ///< voxels from its tip at which the sun's cone is a voxel of lod 1 wide
  double sky_lod1 = 1;  ///< the same of the cones to the sky
  float sun[light_block * light_block][3] = {};  ///< unit, evenly over the sun's disc; a pixel of a block has one each
  float sky[sky_directions][3] = {};  ///< unit, evenly over the upper half; a pixel has sky_rays that follow each other
};

}  // namespace gigabake::kernels
