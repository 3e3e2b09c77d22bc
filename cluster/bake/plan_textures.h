/// Statistics of the textures of some tiles, for a plan.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/source/source.h"

namespace gigabake {

class TileStore;

struct TextureFindings {
  double texel_m = 0;  ///< TexelSize::mean_m(); 0: no tile was examined, or there are no textures
  /// Estimated size of the textures in the whole source that exceed the memory limit: the size found in the examined
  /// tiles, scaled by file bytes. None: no tile was examined.
  std::optional<std::uint64_t> scratch_bytes;
};

/// Examines the textures of `tiles`, which a bake process has already read and baked without failure. `max_bytes` is
/// the max size of a texture in memory.
/// Cost    Begins no further tile after 0.5 s. A large tile is loaded from the store, and only part of its triangles is
///         read.
TextureFindings examine_textures(const SceneSources& sources, const std::vector<std::uint32_t>& tiles,
                                 const TileStore& store, std::uint64_t max_bytes);

}  // namespace gigabake
