#include "format/scene_totals.h"

#include <algorithm>

namespace gigabake {

SceneTotals::SceneTotals(const SceneDescription& scene) {
  for (const SceneCell& c : scene.cells) {
    voxels.resize(std::max<std::size_t>(voxels.size(), c.lods), 0);
    content_hash.resize(voxels.size());
    for (std::size_t lod = 0; lod < c.lods; ++lod) {
      voxels[lod] += c.voxels[lod];
      content_hash[lod] += c.content_hash[lod];
      all_content += c.content_hash[lod];
    }
    bytes += c.bytes;
  }
}

}  // namespace gigabake
