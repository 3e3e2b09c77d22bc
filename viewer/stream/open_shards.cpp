#include "viewer/stream/open_shards.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "format/scene/shard_of_scene.h"

namespace gigabake {

std::size_t open_shards_within(std::uint64_t memory_bytes) {
  constexpr std::uint64_t minimum = 4;
  return std::size_t(std::clamp<std::uint64_t>(memory_bytes / 8 / open_shard_bytes, minimum, max_open_shards));
}

OpenShards::OpenShards(NumberedShards& numbers, std::size_t max_open,
                       std::shared_ptr<std::atomic<std::uint64_t>> files_opened, std::shared_ptr<ChunkCache> chunks)
    : numbers_(numbers), files_opened_(std::move(files_opened)), chunks_(std::move(chunks)), shards_(max_open) {}

std::shared_ptr<OpenShards::Shard> OpenShards::entry_of(std::uint32_t number) {
  std::vector<std::shared_ptr<Shard>> closed;  // destroyed after the lock is released
  const std::scoped_lock lock(mutex_);
  if (const auto* shard = shards_.find(number)) return *shard;
  auto shard = std::make_shared<Shard>();
  closed = shards_.insert(number, shard, 1);
  return shard;
}

std::shared_ptr<const ShardPages> OpenShards::open(std::uint32_t number) {
  const SceneCell description = numbers_.shard(number);
  const std::filesystem::path path = numbers_.scene().folder() / description.file;
  auto pages = std::make_shared<const ShardPages>(path, chunks_);
  if (files_opened_) ++*files_opened_;
  expect_shard_of_scene(path, pages->header(), numbers_.scene().header(), description);
  return pages;
}

std::shared_ptr<const ShardPages> OpenShards::get(std::uint32_t number) {
  const std::shared_ptr<Shard> shard = entry_of(number);
  const std::scoped_lock lock(shard->opening);
  if (!shard->pages) shard->pages = open(number);
  return shard->pages;
}

}  // namespace gigabake
