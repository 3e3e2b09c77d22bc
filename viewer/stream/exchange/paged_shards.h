/// Pages of a scene with pages whose shards are replaced while a viewer shows it.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>

#include "viewer/stream/exchange/shard_table.h"
#include "viewer/stream/page.h"

namespace gigabake {

/// Thread-safe. Replaced shards get numbers behind the numbers of the scene, so pages of previous shards stay valid.
class PagedShards {
 public:
  /// Keeps at most `max_open` shards open. Counts opened files in `files_opened`; null: not counted. `chunks` keeps
  /// unpacked chunks; null: none are kept.
  PagedShards(const std::shared_ptr<const PagedScene>& scene, std::size_t max_open,
              std::shared_ptr<std::atomic<std::uint64_t>> files_opened = {}, std::shared_ptr<ChunkCache> chunks = {});

  /// Adds a shard of the next scene and returns its number.
  std::uint32_t add(const SceneCell& shard) { return first_added_ + added_.add(shard); }
  /// Reads shards that are not replaced from the files of `scene`, whose lists have the same places.
  void show(const std::shared_ptr<const PagedScene>& scene);

  /// Returns a page.
  /// Errors  The errors of PageSource.
  Page page(const PageKey& key);

 private:
  const std::size_t max_open_;
  const std::shared_ptr<std::atomic<std::uint64_t>> files_opened_;
  const std::shared_ptr<ChunkCache> chunks_;
  const std::uint32_t first_added_;  ///< the number of the scene's shards
  ShardTable added_;
  std::mutex mutex_;  ///< guards the member below
  std::shared_ptr<const PageSource> shown_;
};

}  // namespace gigabake
