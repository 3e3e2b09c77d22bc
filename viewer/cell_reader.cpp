#include "viewer/cell_reader.h"

namespace gigabake {

CellReader read_from_shards(const std::filesystem::path& scene_path, const SceneDescription& scene) {
  const auto shard = [folder = scene_path.parent_path(), &scene](std::size_t cell) {
    return folder / scene.cells[cell].file;
  };
  return {[shard](std::size_t cell) { return read_shard_nodes(shard(cell)); },
          [shard](std::size_t cell, int lod) { return read_shard_level(shard(cell), lod); }};
}

}  // namespace gigabake
