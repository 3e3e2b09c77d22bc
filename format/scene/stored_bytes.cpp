#include "format/scene/stored_bytes.h"

#include <algorithm>

#include "format/scene/shard_of_scene.h"

namespace gigabake {

StoredBytes stored_bytes(const PagedScene& scene, const Progress& progress) {
  progress.step("inspecting the shards", scene.totals().cells + scene.totals().overviews);
  StoredBytes bytes;
  const auto add = [&](const SceneCell& c) {
    const ShardReader reader = open_shard_of_scene(scene.file(), scene.header(), c);
    bytes.of_lod.resize(std::max<std::size_t>(bytes.of_lod.size(), c.first_lod + c.lods), 0);
    for (std::size_t l = c.copied_lods; l < c.lods; ++l) bytes.of_lod[c.first_lod + l] += reader.level_bytes(int(l));
    bytes.of_nodes += reader.node_bytes();
    progress.advance();
  };
  scene.for_each_cell(add);
  scene.for_each_overview(add);
  return bytes;
}

}  // namespace gigabake
