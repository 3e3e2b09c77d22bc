#include "viewer/stream/exchange/shard_table.h"

#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/octree/brick.h"
#include "format/scene/shard_of_scene.h"
#include "viewer/stream/open_shards.h"

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

ShardTable::ShardTable(const PagedScene& scene, std::size_t max_open,
                       std::shared_ptr<std::atomic<std::uint64_t>> files_opened, std::shared_ptr<ChunkCache> chunks)
    : folder_(scene.folder()),
      header_(scene.header()),
      files_opened_(std::move(files_opened)),
      chunks_(std::move(chunks)),
      open_(max_open) {}

std::uint32_t ShardTable::add(const SceneCell& shard) {
  const std::scoped_lock lock(mutex_);
  shards_.push_back(shard);
  return std::uint32_t(shards_.size() - 1);
}

ShardNumbers ShardTable::add_all(const PagedScene& scene) {
  ShardNumbers numbers;
  for (const SceneCell& cell : scene.root().cells) numbers.cells.push_back(add(cell));
  for (const SceneCell& overview : scene.root().overviews) numbers.overviews.push_back(add(overview));
  return numbers;
}

void ShardTable::replace(std::uint32_t number, const SceneCell& shard) {
  std::optional<Pages> closed;  // destroyed after the lock is released
  const std::scoped_lock lock(mutex_);
  shards_.at(number) = shard;
  closed = open_.erase(number);
}

ShardTable::Pages ShardTable::open(const SceneCell& shard) const {
  const std::filesystem::path path = folder_ / shard.file;
  auto pages = std::make_shared<const ShardPages>(path, chunks_);
  if (files_opened_) ++*files_opened_;
  expect_shard_of_scene(path, pages->header(), header_, shard);
  return pages;
}

/// Returns the open shard; null if it is an empty tree.
ShardTable::Pages ShardTable::opened(std::uint32_t number) {
  SceneCell shard;
  {
    const std::scoped_lock lock(mutex_);
    if (number >= shards_.size()) throw InputError(folder_, "shard " + std::to_string(number), "is not in the scene");
    if (const Pages* found = open_.find(number)) return *found;
    shard = shards_[number];
  }
  if (shard.file.empty()) return nullptr;
  Pages pages = open(shard);
  std::vector<Pages> closed;  // destroyed after the lock is released
  const std::scoped_lock lock(mutex_);
  if (shards_[number].file == shard.file) closed = open_.insert(number, pages, 1);
  return pages;
}

Page ShardTable::page(const PageKey& key) {
  const Pages pages = opened(key.shard);
  return pages ? page_of(*pages, key) : page_of_empty(key);
}

}  // namespace gigabake
