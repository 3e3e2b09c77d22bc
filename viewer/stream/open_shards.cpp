#include "viewer/stream/open_shards.h"

#include <utility>

#include "format/scene/shard_of_scene.h"
#include "lattice/counted.h"
#include "lattice/error.h"

namespace gigabake {

OpenShards::OpenShards(std::filesystem::path scene_path, const SceneDescription& scene, std::size_t most_open)
    : scene_path_(std::move(scene_path)), scene_(scene), most_open_(most_open) {}

std::shared_ptr<OpenShards::Shard> OpenShards::entry_of(std::uint32_t cell) {
  std::shared_ptr<Shard> closed;  // after the lock is given back
  const std::scoped_lock lock(mutex_);
  if (const auto found = entries_.find(cell); found != entries_.end()) {
    uses_.splice(uses_.begin(), uses_, found->second.use);
    return found->second.shard;
  }
  if (entries_.size() >= most_open_) {
    const auto oldest = entries_.find(uses_.back());
    closed = std::move(oldest->second.shard);
    entries_.erase(oldest);
    uses_.pop_back();
  }
  uses_.push_front(cell);
  return entries_.emplace(cell, Entry{std::make_shared<Shard>(), uses_.begin()}).first->second.shard;
}

std::shared_ptr<const ShardPages> OpenShards::open(std::uint32_t cell) const {
  const SceneCell& description = scene_.cells[cell];
  const std::filesystem::path path = scene_path_.parent_path() / description.file;
  auto pages = std::make_shared<const ShardPages>(path);
  expect_shard_of_scene(path, pages->header(), scene_, description);
  return pages;
}

std::shared_ptr<const ShardPages> OpenShards::get(std::uint32_t cell) {
  if (cell >= scene_.cells.size())
    throw InputError(scene_path_, "cell " + std::to_string(cell),
                     "the scene has " + counted(scene_.cells.size(), "cell"));
  const std::shared_ptr<Shard> shard = entry_of(cell);
  const std::scoped_lock lock(shard->opening);
  if (!shard->pages) shard->pages = open(cell);
  return shard->pages;
}

}  // namespace gigabake
