#include "viewer/stream/page.h"

#include <memory>

#include "viewer/stream/open_shards.h"

namespace gigabake {

std::uint64_t Page::bytes() const {
  return sizeof(Page) + rows.size() * sizeof(NodeRow) + bricks.mask.size() * sizeof(std::uint64_t) +
         bricks.first.size() * sizeof(std::uint32_t) + bricks.rgba.size() + bricks.normal.size() + bricks.facing.size();
}

PageSource pages_from_shards(const std::filesystem::path& scene_path, const SceneDescription& scene) {
  return [shards = std::make_shared<OpenShards>(scene_path, scene, most_open_shards)](const PageKey& key) {
    const auto shard = shards->get(key.cell);
    Page page;
    if (key.lod == -1)
      page.rows = shard->nodes(std::uint64_t(key.block) * nodes_per_block, nodes_per_block);
    else
      page.bricks = shard->level(key.lod, std::uint64_t(key.block) * bricks_per_block, bricks_per_block);
    return page;
  };
}

}  // namespace gigabake
