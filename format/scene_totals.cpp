#include "format/scene_totals.h"

#include <algorithm>

#include "format/error.h"
#include "format/shard_reader.h"

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

StoredBytes stored_bytes(const std::filesystem::path& scene_xml, const SceneDescription& scene) {
  StoredBytes bytes;
  for (const SceneCell& c : scene.cells) {
    const std::filesystem::path path = scene_xml.parent_path() / c.file;
    const ShardReader reader(path);
    if (reader.header().lods != c.lods) throw InputError(path, "lods", "differs from scene.xml; run gigabake verify");
    bytes.of_lod.resize(std::max<std::size_t>(bytes.of_lod.size(), c.lods), 0);
    for (std::size_t lod = 0; lod < c.lods; ++lod) bytes.of_lod[lod] += reader.level_bytes(int(lod));
    bytes.of_nodes += reader.node_bytes();
  }
  return bytes;
}

}  // namespace gigabake
