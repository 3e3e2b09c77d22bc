/// The rays of a tile of an image: their state, the dither ranks of their pixels, and the output arrays.
///
/// Space   Distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float, no transcendental functions: host and device return the same bits.
#pragma once

#include <cstdint>
#include <functional>

#include "core/base/host_device.h"
#include "core/math/vec3.h"

namespace gigabake::kernels {

/// The state of a ray. An unfinished ray continues from this state in the next pass.
struct alignas(16) CastRay {
  Vec3<float> rgb{0, 0, 0};  ///< linear, premultiplied
  float transmittance = 1;
  float covered = 0;       ///< sum of the coverages of all surfaces so far: 1 is opaque
  float before = 0;        ///< value of `covered` at the start of the current surface
  float apart = 0;         ///< distance from which on samples belong to another surface
  float depth = no_depth;  ///< distance at which half of the light has been absorbed
  double step = 0;         ///< index of the level's next sample, an integer
  double past = -1;        ///< index after the level's latest sample in a surface, an integer; -1: none yet

  double met = 0;  ///< distance of the latest hit of a blended surface before the current sample
  float signed_distance =
      no_signed_distance;  ///< signed distance of the previous sample, lod-0 voxels; no_signed_distance: no surface
  float signed_distance_at = 0;  ///< distance of that sample along the ray
  float slope = 0;               ///< change of the signed distance per lod-0 voxel along the ray at that sample
  std::int32_t lod = -1;         ///< -1: finished
  bool is_other_side = false;    ///< the ray meets the current surface on the side opposite to its normals
  bool is_seen = false;          ///< the hit at `met` has been composited
  bool is_behind = false;        ///< the ray came to that sample from the side opposite to its normals
  std::uint8_t surface_lod = 0;  ///< level of the brick that held that sample
  std::uint32_t normal = 0;      ///< ByteVector: normal of the surface at that sample; 0: no surface

  static constexpr float no_depth = 3e38f, no_signed_distance = 3e38f;
};

/// Returns e^-x for x ≥ 0 with a relative error of 2e-5. For x > 16 the result is constant and less than 2e-7.
GB_HD float exp_minus(float x) {
  const float y = (x < 16 ? x : 16) * (-1.0f / 64);
  float e = 1 + y * (1 + y * (0.5f + y * (1.0f / 6 + y * (1.0f / 24 + y * (1.0f / 120)))));
  for (int i = 0; i < 6; ++i) e *= e;
  return e;
}

/// A rectangle of the image: ray i is pixel (x + i mod width, y + i div width).
struct CastTile {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Returns a rank from 0 to 63 within an 8 × 8 square of pixels; ranks of neighbouring pixels differ strongly.
/// Source  Bayer 1973.
GB_HD std::uint32_t dither_rank(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t d = x ^ y;
  return (d & 1) << 5 | (y & 1) << 4 | (d & 2) << 2 | (y & 2) << 1 | (d & 4) >> 1 | (y & 4) >> 2;
}

/// A function that returns true if the current work should stop early. Several threads call it, about once a
/// millisecond. An empty function means that the work never stops early.
using StopAsked = std::function<bool()>;

/// Output arrays for the pixels of a tile, row by row; null: not requested.
struct CastPixels {
  std::uint8_t* srgb = nullptr;  ///< four bytes per pixel: RGBA, straight alpha
  float* linear = nullptr;       ///< four values per pixel: RGBA, premultiplied, not limited to 1
  float* depth = nullptr;        ///< voxels; CastRay::no_depth if at least half of the light passes through
};

}  // namespace gigabake::kernels
