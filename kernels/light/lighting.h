/// The light of an image in which surfaces cast shadows.
///
/// Space   Directions of the scene: x east, y north, z up.
/// Source  Keller and Heidrich 2001, "Interleaved Sampling"; Crassin et al. 2011, "Interactive Indirect Illumination
///         Using Voxel Cone Tracing".
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/cast_camera.h"

namespace gigabake::kernels {

/// The pixels of a block of sun_block × sun_block sample different parts of the sun.
inline constexpr int sun_block = 4, sun_directions = sun_block * sun_block;
/// The pixels of a block of sky_block × sky_block sample different parts of the sky. Every other pixel of the block
/// casts a ray to the sky, and the remaining pixels reuse the results.
inline constexpr int sky_block = 8, sky_directions = sky_block * sky_block / 2;

/// The part of the light that an image shows.
enum class CastLightPart : std::int32_t {
  all,
  sun,        ///< light of the sun only
  sky,        ///< light of the sky, and of the surfaces that hide parts of the sky
  shadow,     ///< visible fraction of the sun; white: the whole sun is visible
  unshadowed  ///< all light without shadows: no rays are cast to the light
};

struct CastLighting {
  CastLight light;  ///< the unshadowed light
  CastLightPart part = CastLightPart::all;
  CastHaze haze;        ///< applied after shading; the camera's own haze must be off
  double sun_lod1 = 1;  ///< distance from the cone's tip, in voxels, at which the sun's cone is as wide
                        ///< as a lod-1 voxel
  double sky_lod1 = 1;  ///< the distance at which a cone to the sky is as wide
  Vec3<float> sun[sun_directions] =
      {};  ///< unit vectors, evenly over the sun's disc, by the pixel's position in its block
  Vec3<float> sky[sky_directions] =
      {};  ///< unit vectors, evenly over the upper hemisphere, by the pixel's position in its block
};

}  // namespace gigabake::kernels
