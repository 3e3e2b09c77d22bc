/// Exact rendering of a scene's image: each ray waits for the data that it needs.
#pragma once

#include <memory>
#include <optional>

#include "kernels/light/shader.h"
#include "kernels/light/surface_point.h"
#include "kernels/marching/cast.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/picture.h"
#include "viewer/stream/scene_stream.h"

namespace gigabake {

/// The background and lighting of an image, applied to the results of its rays.
struct RenderSettings {
  kernels::CastBackground background;
  std::optional<kernels::CastLighting> lighting = {};         ///< applied per pixel; rays must return unlit colours
  std::shared_ptr<const kernels::SurfaceShader> shader = {};  ///< shader for `lighting`; null: kernels::LitShader
  bool blends_levels = false;                                 ///< see kernels/marching/level_blend.h
};

/// The max memory per pixel of a tile on the host: two rays, the lit ray, the light, and the pixel itself.
inline constexpr std::uint64_t tile_bytes_per_pixel = 3 * sizeof(kernels::CastRay) + sizeof(kernels::PixelLight) + 24;

/// The passes of rays over tiles.
/// Exact   Equal in every run with enough memory, unless a page takes longer than 50 ms.
struct PassCounts {
  std::uint64_t passes = 0;
  std::uint64_t page_waits = 0;  ///< waits for pages that were requested after the latest pass: no rays could be cast
};

/// Renders one tile into the whole image and adds to `counts`. Returns false if `stop` cancelled the tile; the image is
/// unchanged then. On the CPU a large tile has two groups of rows: one is cast while the pages of the other are read.
/// Exact   The pixels are the same as in render(), for all tilings whose tiles begin at multiples of
///         kernels::light_region.
bool render_tile(SceneStream& stream, const kernels::CastCamera& camera, const kernels::CastTile& tile,
                 const RenderSettings& look, const kernels::StopAsked& stop, Picture& picture, PassCounts& counts);

/// Renders the whole image.
/// Exact   The bytes are the same for any number of threads and any memory budget of `stream`. Damaged parts are
///         replaced by the next coarser intact level; see SceneStream::problems().
/// Space   8 bytes per pixel, 24 with linear light, in addition to `stream`.
Picture render(SceneStream& stream, const kernels::CastCamera& camera, const RenderSettings& look, PictureLight light);
/// Renders the whole image with a background and lighting; other settings have their defaults.
Picture render(SceneStream& stream, const kernels::CastCamera& camera, const Background& background,
               PictureLight light = PictureLight::srgb, const std::optional<kernels::CastLighting>& lighting = {});

}  // namespace gigabake
