/// What rays are cast for: an eye and its picture, the air before it, and what a screen shows of light.
///
/// Space   Lod-0 voxels of the scene's lattice; distances in them too.
/// Exact   IEEE float, no transcendental functions: host and device return the same bits.
#pragma once

#include <cstdint>

#include "kernels/cast/scene.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// Light that reaches the eye from the air before the surface: 1 - e^(-distance · per_voxel) of it.
struct CastHaze {
  float rgb[3] = {0, 0, 0};
  float per_voxel = 0;
};

/// From light to what a screen shows: light · exposure as it is up to the knee; what is brighter is bent so that it
/// stays below 1, whites beside each other differ, and there is no edge at the knee.
struct CastTone {
  float exposure = 1;
  float knee = 1;  ///< 0 to 1; 1: light beyond 1 is cut off
};

/// Rises with light ≥ 0.
GB_HD float shown_light(const CastTone& tone, float light) {
  const float exposed = light * tone.exposure, rest = 1 - tone.knee, over = exposed - tone.knee;
  return over <= 0 || rest <= 0 ? exposed : tone.knee + rest * (over / (over + rest));
}

/// What a ray makes of what is there.
enum class CastPaint : std::int32_t {
  shaded,  ///< the voxels' radiance
  lod,     ///< one colour a level
  cell,    ///< one colour a cell
  waits,   ///< red where something finer was asked for
};

/// What rays see at all: what is in the box, and where normal · p ≥ offset. Everything, as it stands here.
struct CastClip {
  double min[3] = {-double(far_voxel), -double(far_voxel), -double(far_voxel)};
  double max[3] = {double(far_voxel), double(far_voxel), double(far_voxel)};
  double normal[3] = {0, 0, 0};
  double offset = 0;
};

/// What stands among the voxels, a pixel of the whole picture each, row 0 the upper one; null: nothing does.
struct CastPolygons {
  const float* distance = nullptr;  ///< along the pixel's ray; CastPolygons::nowhere: nothing stands there
  const float* rgba = nullptr;      ///< what it sends: linear RGB, premultiplied by how much of what is behind it hides

  static constexpr float nowhere = 3e38f;
};

struct CastCamera {
  double eye[3] = {};
  double forward[3] = {};            ///< unit
  double right[3] = {}, up[3] = {};  ///< from the picture's middle to its edge, where forward ends
  std::int32_t width = 0, height = 0;
  double lod1_depth = 0;  ///< depth (along forward) from which voxels of lod 1 are at most a pixel wide; > 0
  CastHaze haze;
  CastTone tone;
  CastPaint paint = CastPaint::shaded;
  CastClip clip;
  CastPolygons polygons;  ///< of the caster's memory; a caller's, where it starts a tile
};

}  // namespace gigabake::kernels
