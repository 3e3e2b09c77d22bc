#include "format/scene/scene_totals.h"

#include <algorithm>

#include "format/scene/shard_of_scene.h"

namespace gigabake {

SceneTotals::SceneTotals(const SceneDescription& scene) {
  for (const auto& shards : {&scene.cells, &scene.parents})
    for (const SceneCell& c : *shards) add(c);
}

void SceneTotals::add(const SceneCell& c) {
  voxels.resize(std::max<std::size_t>(voxels.size(), c.first_lod + c.lods), 0);
  content_hash.resize(voxels.size());
  for (std::size_t l = 0; l < c.lods; ++l) {
    voxels[c.first_lod + l] += c.voxels[l];
    content_hash[c.first_lod + l] += c.content_hash[l];
    all_content += c.content_hash[l];
  }
  bytes += c.bytes;
}

StoredBytes stored_bytes(const std::filesystem::path& scene_xml, const SceneDescription& scene,
                         const Progress& progress) {
  progress.step("looking into the shards", scene.cells.size() + scene.parents.size());
  StoredBytes bytes;
  for (const auto& shards : {&scene.cells, &scene.parents})
    for (const SceneCell& c : *shards) {
      const ShardReader reader = open_shard_of_scene(scene_xml, scene, c);
      bytes.of_lod.resize(std::max<std::size_t>(bytes.of_lod.size(), c.first_lod + c.lods), 0);
      for (std::size_t l = 0; l < c.lods; ++l) bytes.of_lod[c.first_lod + l] += reader.level_bytes(int(l));
      bytes.of_nodes += reader.node_bytes();
      progress.advance();
    }
  return bytes;
}

}  // namespace gigabake
