/// Image of a scene, and its tiles.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/marching/cast_ray.h"

namespace gigabake {

/// An image; row 0 is the top row.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< sRGB, straight alpha
  /// Distance along the ray, in lod-0 voxels, at which half of the light is absorbed. CastRay::no_depth if less than
  /// half of the light is absorbed; 0 in pixels that are not rendered yet.
  std::vector<float> depth = {};
  std::vector<float> linear = {};  ///< RGBA, premultiplied, may exceed 1; empty unless requested
};

/// The light values that an image stores.
enum class PictureLight : std::uint8_t {
  srgb,
  linear_too,  ///< sRGB and `Picture::linear`
};

/// Returns an image of zeros.
Picture blank_picture(int width, int height, PictureLight light);
/// Returns the image in another size, as a preview: interpolated colours, and the depth of the nearest pixel.
Picture enlarged(const Picture& picture, int width, int height, PictureLight light);
/// Returns pointers to the pixels of the image, which the caller continues to own.
kernels::CastPixels pixels_of(Picture& picture);

/// Returns the tiles of an image, from its middle outwards, because users look at the middle first.
std::vector<kernels::CastTile> tiles_of(int width, int height, int edge);
/// Returns a minimal number of tiles of at most `max_pixels` pixels, in the same order. Their edges are multiples of
/// `unit`; tiles have unit × unit pixels if even this is more than `max_pixels`.
std::vector<kernels::CastTile> large_tiles_of(int width, int height, int unit, std::uint64_t max_pixels);

}  // namespace gigabake
