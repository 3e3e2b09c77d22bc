#include "viewer/stream/watched_shards.h"

#include "core/base/error.h"
#include "core/octree/brick.h"
#include "format/scene/shard_of_scene.h"

namespace gigabake {
namespace {

/// Returns a page of a shard whose only node, the root, has a brick without voxels.
Page page_of_empty(const PageKey& key) {
  Page page;
  if (key.part == PageKey::node_rows) {
    page.rows.resize(1);
  } else {
    page.bricks.mask.assign(brick_edge, 0);
    page.bricks.first = {0, 0};
  }
  return page;
}

}  // namespace

WatchedShards::WatchedShards(const PagedScene& scene, std::size_t max_open)
    : folder_(scene.folder()), header_(scene.header()), cells_(scene.root().cells), shards_(max_open) {}

void WatchedShards::replace(std::uint32_t number, const SceneCell& cell) {
  std::optional<Pages> closed;  // destroyed after the lock is released
  const std::scoped_lock lock(mutex_);
  cells_.at(number) = cell;
  closed = shards_.erase(number);
}

WatchedShards::Pages WatchedShards::open(const SceneCell& cell) const {
  const std::filesystem::path path = folder_ / cell.file;
  auto pages = std::make_shared<const ShardPages>(path);
  expect_shard_of_scene(path, pages->header(), header_, cell);
  return pages;
}

/// Returns the open shard of a cell; null if the cell has none.
WatchedShards::Pages WatchedShards::shard(std::uint32_t number) {
  SceneCell cell;
  {
    const std::scoped_lock lock(mutex_);
    if (number >= cells_.size()) throw InputError(folder_, "shard " + std::to_string(number), "there is no such cell");
    if (const Pages* opened = shards_.find(number)) return *opened;
    cell = cells_[number];
  }
  if (cell.file.empty()) return nullptr;
  Pages pages = open(cell);
  std::vector<Pages> closed;  // destroyed after the lock is released
  const std::scoped_lock lock(mutex_);
  if (cells_[number].file == cell.file) closed = shards_.insert(number, pages, 1);
  return pages;
}

Page WatchedShards::page(const PageKey& key) {
  const Pages pages = shard(key.shard);
  if (!pages) return page_of_empty(key);
  Page page;
  if (key.part == PageKey::node_rows)
    page.rows = pages->nodes(std::uint64_t(key.block) * nodes_per_block, nodes_per_block);
  else
    page.bricks = pages->level(key.part, std::uint64_t(key.block) * bricks_per_block, bricks_per_block);
  return page;
}

}  // namespace gigabake
