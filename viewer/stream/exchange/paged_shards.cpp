#include "viewer/stream/exchange/paged_shards.h"

#include <utility>

#include "viewer/stream/open_shards.h"

namespace gigabake {

PagedShards::PagedShards(const std::shared_ptr<const PagedScene>& scene, std::size_t max_open,
                         std::shared_ptr<std::atomic<std::uint64_t>> files_opened, std::shared_ptr<ChunkCache> chunks)
    : max_open_(max_open),
      files_opened_(std::move(files_opened)),
      chunks_(std::move(chunks)),
      first_added_(std::uint32_t(scene->totals().cells + scene->totals().overviews)),
      added_(*scene, max_open, files_opened_, chunks_) {
  show(scene);
}

void PagedShards::show(const std::shared_ptr<const PagedScene>& scene) {
  auto source = std::make_shared<const PageSource>(pages_from_open_shards(scene, files_opened_, max_open_, chunks_));
  const std::scoped_lock lock(mutex_);
  std::swap(shown_, source);  // the previous source is destroyed after the lock is released
}

Page PagedShards::page(const PageKey& key) {
  const bool is_listing = key.part <= PageKey::listing;
  if (!is_listing && key.shard >= first_added_) return added_.page({key.shard - first_added_, key.part, key.block});
  std::shared_ptr<const PageSource> source;
  {
    const std::scoped_lock lock(mutex_);
    source = shown_;
  }
  return (*source)(key);
}

}  // namespace gigabake
