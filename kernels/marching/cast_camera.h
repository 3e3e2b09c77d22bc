/// The camera that rays are cast for: eye and image plane, haze, clipping, background, and the tone
/// curve of the screen. Also the light of sun and sky without shadows.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float, no transcendental functions: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/voxel_space.h"

namespace gigabake::kernels {

/// Haze: the fraction 1 - e^(-distance · per_voxel) of the light that reaches the eye comes from the air.
struct CastHaze {
  Vec3<float> rgb{0, 0, 0};
  float per_voxel = 0;
};

/// The tone curve from light to displayed values. Up to the knee the value is light · exposure. Brighter light is
/// compressed smoothly: it stays below 1, and different intensities remain distinguishable.
struct CastTone {
  float exposure = 1;
  float knee = 1;  ///< 0 to 1; 1: values are not compressed, and are clamped at 1
};

/// Returns the displayed value of a light ≥ 0; increases monotonically.
GB_HD float shown_light(const CastTone& tone, float light) {
  const float exposed = light * tone.exposure, rest = 1 - tone.knee, over = exposed - tone.knee;
  return over <= 0 || rest <= 0 ? exposed : tone.knee + rest * (over / (over + rest));
}

/// Linear RGB of a sky: at the horizon, straight up, straight down.
struct CastSky {
  Vec3<float> horizon{0, 0, 0}, zenith{0, 0, 0}, nadir{0, 0, 0};
};

/// The background behind the voxels: a sky, or one premultiplied linear colour.
struct CastBackground {
  bool has_sky = false;
  CastSky sky;
  Vec3<float> rgb{0, 0, 0};
  float alpha = 0;
};

/// The colours that a ray shows.
enum class DebugColor : std::int32_t {
  shaded,  ///< the voxels' radiance
  lod,     ///< one debug colour per level
  cell,    ///< one debug colour per cell
  waits,   ///< red where finer data was requested
};

/// The visible part of the scene: the box and the half-space normal · p ≥ offset. Everything is visible by default.
struct CastClip {
  Vec3d min = Vec3d::all(-double(far_voxel)), max = Vec3d::all(double(far_voxel));
  Vec3d normal{0, 0, 0};
  double offset = 0;
};

/// Polygons that are shown together with the voxels. They are already rendered: the arrays have one entry per pixel of
/// the whole image, row 0 at the top. Null pointers mean that there are no polygons.
struct CastPolygons {
  const float* distance = nullptr;  ///< along the pixel's ray; CastPolygons::nowhere: no polygon
  const float* rgba = nullptr;      ///< linear RGB, premultiplied by the opacity

  static constexpr float nowhere = 3e38f;
};

struct CastCamera {
  Vec3d eye{};
  Vec3d forward{};      ///< unit vector
  Vec3d right{}, up{};  ///< from the image's centre to its right and upper edges, at the tip of `forward`
  std::int32_t width = 0, height = 0;
  double lod1_depth = 0;  ///< depth (along `forward`) from which lod-1 voxels are at most the pixel error wide; > 0
  CastHaze haze;
  CastTone tone;
  DebugColor debug_color = DebugColor::shaded;
  CastClip clip;
  CastPolygons polygons;  ///< in the caster's memory; as an argument of Caster::start(), in the caller's memory
};

/// Linear RGB irradiance; irradiance 1 shows a surface in its own colour.
struct CastLight {
  Vec3<float> to_sun{0, 0, 1};  ///< unit vector
  Vec3<float> sun{0, 0, 0};     ///< on a surface that faces the sun
  Vec3<float> sky{1, 1, 1};     ///< on a surface that faces up
  Vec3<float> ground{1, 1, 1};  ///< on a surface that faces down; interpolated with `sky` by the normal's z
};

/// Returns a light that shows surfaces in their own colours.
GB_HD CastLight unlit() { return CastLight{}; }

/// Tests whether surfaces of different normals receive different light.
inline bool depends_on_normal(const CastLight& light) {
  return light.sun != Vec3<float>{0, 0, 0} || light.sky != light.ground;
}

/// Returns a channel of the irradiance of a surface with the given unit normal.
GB_HD float irradiance(const CastLight& light, const Vec3<float>& normal, int channel) {
  const float cosine = dot(normal, light.to_sun), up = 0.5f + 0.5f * normal[2];
  return light.sun[channel] * (cosine > 0 ? cosine : 0) + (light.sky[channel] * up + light.ground[channel] * (1 - up));
}

}  // namespace gigabake::kernels
