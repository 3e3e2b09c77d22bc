#include "format/scene/scene_totals.h"

#include <algorithm>

#include "format/scene/shard_of_scene.h"

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

StoredBytes stored_bytes(const std::filesystem::path& scene_xml, const SceneDescription& scene,
                         const Progress& progress) {
  progress.step("looking into the shards", scene.cells.size());
  StoredBytes bytes;
  for (const SceneCell& c : scene.cells) {
    const ShardReader reader = open_shard_of_scene(scene_xml, scene, c);
    bytes.of_lod.resize(std::max<std::size_t>(bytes.of_lod.size(), c.lods), 0);
    for (std::size_t lod = 0; lod < c.lods; ++lod) bytes.of_lod[lod] += reader.level_bytes(int(lod));
    bytes.of_nodes += reader.node_bytes();
    progress.advance();
  }
  return bytes;
}

}  // namespace gigabake
