/// A texture as the kernels sample it: a borrowed MIP pyramid whose coarser levels hold premultiplied 16-bit linear
/// RGBA.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake::kernels {

inline constexpr int max_texture_levels = 24;

/// MIP pyramid of a texture. Level 0 is the image itself (sRGB, straight alpha, 4 bytes per texel). A texel of a level
/// ≥ 1 is linear, premultiplied RGBA with 16 bits per channel. If `mask_cutoff` > 0, alpha of these levels is the
/// fraction of texels that pass the alpha test. Level l has level_extent(width, l) × level_extent(height, l) texels.
/// Range   width · height ≤ 2^30.
struct TextureView {
  const std::uint8_t* base = nullptr;
  const std::uint16_t* level[max_texture_levels] = {};  ///< [0] is unused
  std::int32_t width = 0, height = 0, levels = 0;
  std::uint8_t mask_cutoff = 0;  ///< 0: no alpha test; else texel alpha ≥ cutoff is opaque and less is transparent
  bool is_opaque = false;        ///< all texels pass the alpha test, or have alpha 1 if there is no test
  std::uint64_t id = 0;          ///< unique number of the Texture, never reused: a device identifies its resident
                                 ///< textures by it
};

/// Returns the number of texels of a level along one axis. `size` is the number at level 0.
GB_HD std::int32_t level_extent(std::int32_t size, int level) { return size >> level > 1 ? size >> level : 1; }

}  // namespace gigabake::kernels
