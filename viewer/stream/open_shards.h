/// LRU cache of a scene's open shards: opens a shard at its first request and keeps a bounded number open.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>

#include "core/base/lru_cache.h"
#include "format/shard/shard_pages.h"
#include "viewer/stream/numbered_shards.h"

namespace gigabake {

/// The memory of an open shard: caches of the file, and the index of the file's chunks. Measured on shards of 1 MB.
inline constexpr std::uint64_t open_shard_bytes = std::uint64_t(320) << 10;

/// Returns the number of shards that may be open: as many as fit into an eighth of `memory_bytes`, but 4 to 400.
std::size_t open_shards_within(std::uint64_t memory_bytes);

/// Returns the same source as pages_from_files() (page.h), but with at most `max_open` open shards. `chunks` keeps
/// their unpacked chunks; null: none are kept.
PageSource pages_from_open_shards(std::shared_ptr<const PagedScene> scene,
                                  std::shared_ptr<std::atomic<std::uint64_t>> files_opened, std::size_t max_open,
                                  std::shared_ptr<ChunkCache> chunks = {});

class OpenShards {
 public:
  /// Borrows `numbers`. Counts each opened shard in `files_opened`; null: not counted. `chunks` keeps unpacked chunks;
  /// null: none are kept.
  OpenShards(NumberedShards& numbers, std::size_t max_open,
             std::shared_ptr<std::atomic<std::uint64_t>> files_opened = {}, std::shared_ptr<ChunkCache> chunks = {});

  /// Returns an open shard, which stays open while the pointer is held. Thread-safe: a thread that waits for its file
  /// does not block other threads.
  /// Errors  InputError: unknown number, no such file, not a shard, or a different shard than the scene refers to.
  std::shared_ptr<const ShardPages> get(std::uint32_t number);

 private:
  struct Shard {
    std::mutex opening;
    std::shared_ptr<const ShardPages> pages;
  };
  std::shared_ptr<Shard> entry_of(std::uint32_t number);
  std::shared_ptr<const ShardPages> open(std::uint32_t number);

  NumberedShards& numbers_;
  std::shared_ptr<std::atomic<std::uint64_t>> files_opened_;
  std::shared_ptr<ChunkCache> chunks_;
  std::mutex mutex_;
  LruCache<std::uint32_t, std::shared_ptr<Shard>> shards_;  ///< by number; the cost of a shard is 1
};

/// Returns the page of node rows or bricks that the key names.
/// Errors  InputError, as ShardPages::nodes() and level().
Page page_of(const ShardPages& shard, const PageKey& key);

}  // namespace gigabake
