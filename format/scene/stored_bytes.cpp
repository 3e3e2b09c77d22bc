#include "format/scene/stored_bytes.h"

#include <algorithm>

#include "format/scene/shard_of_scene.h"

namespace gigabake {

StoredBytes stored_bytes(const PagedScene& scene, const Progress& progress) {
  progress.step("looking into the shards", scene.totals().cells);
  StoredBytes bytes;
  scene.for_each_cell([&](const SceneCell& c) {
    const ShardReader reader = open_shard_of_scene(scene.file(), scene.header(), c);
    bytes.of_lod.resize(std::max<std::size_t>(bytes.of_lod.size(), c.lods), 0);
    for (std::size_t lod = 0; lod < c.lods; ++lod) bytes.of_lod[lod] += reader.level_bytes(int(lod));
    bytes.of_nodes += reader.node_bytes();
    progress.advance();
  });
  return bytes;
}

}  // namespace gigabake
