/// A picture of a scene, exact: each ray waits for what it needs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "kernels/cast/cast.h"
#include "kernels/cast/pixel.h"
#include "kernels/cast/shader.h"
#include "viewer/light/sky.h"
#include "viewer/stream/scene_stream.h"

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
/// The picture in another size, for want of a better one: colours between pixels, distances of the nearest pixel.
Picture enlarged(const Picture& picture, int width, int height, PictureLight light);
/// Borrows.
kernels::CastPixels pixels_of(Picture& picture);

/// The tiles of a picture, from its middle outwards: what is looked at comes first.
std::vector<kernels::CastTile> tiles_of(int width, int height, int edge);

/// What a picture shows of light besides its rays' own.
struct PictureLook {
  kernels::CastBackground background;
  std::optional<kernels::CastLighting> lighting = {};  ///< lights surface's own colours, which rays must bring back
  std::shared_ptr<const kernels::SurfaceShader> shader = {};  ///< of that light; null: kernels::LitShader
  bool blends_levels = false;                                 ///< kernels/cast/level_blend.h
};

/// The pixels of one tile, into the whole picture. False where `stop` ended it: nothing of it is written then.
/// Exact   As render(), whatever tiles the picture has.
bool render_tile(SceneStream& stream, const kernels::CastCamera& camera, const kernels::CastTile& tile,
                 const PictureLook& look, const kernels::StopAsked& stop, Picture& picture);

/// Exact   The same bytes for any number of threads and any memory budget of `stream`. What is damaged is drawn as the
///         next coarser level that is not; see SceneStream::problems().
/// Space   8 bytes a pixel, 24 with linear light, and `stream`.
Picture render(SceneStream& stream, const kernels::CastCamera& camera, const PictureLook& look, PictureLight light);
/// The same, with no more than a background and light.
Picture render(SceneStream& stream, const kernels::CastCamera& camera, const Background& background,
               PictureLight light = PictureLight::srgb, const std::optional<kernels::CastLighting>& lighting = {});

}  // namespace gigabake
