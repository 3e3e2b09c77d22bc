/// What a plan finds in the textures of some tiles.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/source/source.h"

namespace gigabake {

class TileStore;

struct TextureFindings {
  double texel_m = 0;  ///< TexelSize::mean_m(); 0: no tile was looked at, or there are no textures
  /// Of textures that are too large for the memory, in all of the source: of the tiles that were looked at, times what
  /// the others have more of bytes. None: no tile was looked at.
  std::optional<std::uint64_t> scratch_bytes;
};

/// tiles: that a bake process has read and baked without harm. most_bytes: of a texture in memory.
/// Cost  Half a second and one more tile; of a large tile, which comes from the store, a part of its triangles.
TextureFindings look_at_textures(const SceneSources& sources, const std::vector<std::uint32_t>& tiles,
                                 const TileStore& store, std::uint64_t most_bytes);

}  // namespace gigabake
