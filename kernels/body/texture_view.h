/// A texture as bodies sample it: a borrowed MIP pyramid whose levels hold premultiplied 16-bit linear RGBA.
#pragma once

#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake::kernels {

inline constexpr int max_texture_levels = 24;

/// Level 0 is the image itself (sRGB, straight alpha, 4 bytes a texel); levels ≥ 1 are 4 × uint16 linear,
/// premultiplied; where `mask_cutoff` > 0 their alpha is the share of texels that pass the alpha test. Level l has
/// level_extent(width, l) × level_extent(height, l) texels. Range  width · height ≤ 2^30.
struct TextureView {
  const std::uint8_t* base = nullptr;
  const std::uint16_t* level[max_texture_levels] = {};  ///< [0] is unused
  std::int32_t width = 0, height = 0, levels = 0;
  std::uint8_t mask_cutoff = 0;  ///< 0: no alpha test; else texel alpha ≥ cutoff is opaque and less is absent
  std::uint64_t id = 0;          ///< of the Texture, never given twice: a device knows by it what it already holds
};

/// Texels of a level along one axis, of `size` at level 0.
GB_HD std::int32_t level_extent(std::int32_t size, int level) { return size >> level > 1 ? size >> level : 1; }

}  // namespace gigabake::kernels
