/// The shards of a scene that are open: opened when asked for, a bounded number of them, the longest unused closed.
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "format/shard/shard_pages.h"
#include "viewer/stream/numbered_shards.h"

namespace gigabake {

/// What an open shard takes: its file's caches and the index of its chunks, measured on shards of 1 MB.
inline constexpr std::uint64_t open_shard_bytes = std::uint64_t(320) << 10;

/// Returns how many shards may be open within a limit of memory: those that an eighth of it holds, 4 to 400.
std::size_t open_shards_within(std::uint64_t memory_bytes);

/// Like pages_from_files() (page.h), with another limit of open shards.
PageSource pages_from_open_shards(std::shared_ptr<const PagedScene> scene,
                                  std::shared_ptr<std::atomic<std::uint64_t>> files_opened, std::size_t most_open);

class OpenShards {
 public:
  /// Borrows `numbers`. files_opened: where given, counts each shard that is opened.
  OpenShards(NumberedShards& numbers, std::size_t most_open,
             std::shared_ptr<std::atomic<std::uint64_t>> files_opened = {});

  /// Any number of threads; others go on while one waits for its file. What was given stays open while it is held.
  /// Errors  InputError: no such number, no such file, not a shard, not the one that the scene means.
  std::shared_ptr<const ShardPages> get(std::uint32_t number);

 private:
  struct Shard {
    std::mutex opening;
    std::shared_ptr<const ShardPages> pages;
  };
  struct Entry {
    std::shared_ptr<Shard> shard;
    std::list<std::uint32_t>::iterator use;
  };
  std::shared_ptr<Shard> entry_of(std::uint32_t number);
  std::shared_ptr<const ShardPages> open(std::uint32_t number);

  NumberedShards& numbers_;
  std::size_t most_open_;
  std::shared_ptr<std::atomic<std::uint64_t>> files_opened_;
  std::mutex mutex_;
  std::list<std::uint32_t> uses_;  ///< numbers, the last used in front
  std::unordered_map<std::uint32_t, Entry> entries_;
};

}  // namespace gigabake
