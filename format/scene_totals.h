/// Sums over a scene's cells.
#pragma once

#include <cstdint>
#include <vector>

#include "format/scene_xml.h"

namespace gigabake {

/// Indexed by lod, up to the highest that any cell has.
struct SceneTotals {
  explicit SceneTotals(const SceneDescription& scene);
  std::vector<std::uint64_t> voxels;
  std::vector<Hash128> content_hash;
  Hash128 all_content;  ///< of all lods
  std::uint64_t bytes = 0;
};

}  // namespace gigabake
