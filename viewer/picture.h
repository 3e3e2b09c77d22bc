/// A picture of a scene, exact: each ray waits for what it needs.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cast.h"
#include "viewer/scene_stream.h"
#include "viewer/sky.h"

namespace gigabake {

/// sRGB, straight alpha; row 0 is the upper one.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  std::vector<float> depth =
      {};  ///< voxels along the ray to where half of the light is gone; CastRay::no_depth: nowhere
};

/// Exact   The same bytes for any number of threads and any memory budget of `stream`. What is damaged is drawn as the
///         next coarser level that is not; see SceneStream::problems().
/// Space   8 bytes a pixel, and `stream`.
Picture render(SceneStream& stream, const kernels::CastCamera& camera, const Background& background);

}  // namespace gigabake
