/// A picture of a scene, exact: each ray waits for what it needs.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cast.h"
#include "kernels/cast_pixel.h"
#include "viewer/scene_stream.h"
#include "viewer/sky.h"

namespace gigabake {

/// Row 0 is the upper one.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< sRGB, straight alpha
  /// Voxels along the ray to where half of the light is gone; CastRay::no_depth: nowhere.
  std::vector<float> depth = {};
  std::vector<float> linear = {};  ///< RGBA, premultiplied, may be brighter than 1; empty where not asked for
};

/// What light of a picture is wanted.
enum class PictureLight : std::uint8_t {
  srgb,
  linear_too,  ///< Picture::linear besides
};

/// All zeros.
Picture blank_picture(int width, int height, PictureLight light);
/// Borrows.
kernels::CastPixels pixels_of(Picture& picture);

/// Exact   The same bytes for any number of threads and any memory budget of `stream`. What is damaged is drawn as the
///         next coarser level that is not; see SceneStream::problems().
/// Space   8 bytes a pixel, 24 with linear light, and `stream`.
Picture render(SceneStream& stream, const kernels::CastCamera& camera, const Background& background,
               PictureLight light = PictureLight::srgb);

}  // namespace gigabake
