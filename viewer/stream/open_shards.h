/// The shards of a scene that are open: opened when asked for, a bounded number of them, the longest unused closed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "format/scene/scene_xml.h"
#include "format/shard/shard_pages.h"

namespace gigabake {

class OpenShards {
 public:
  /// Borrows `scene`, which was read from `scene_path`.
  OpenShards(std::filesystem::path scene_path, const SceneDescription& scene, std::size_t most_open);

  /// Any number of threads; others go on while one waits for its file. What was given stays open while it is held.
  /// Errors  InputError: no such cell, no such file, not a shard, not the one that `scene` means.
  std::shared_ptr<const ShardPages> get(std::uint32_t cell);

 private:
  struct Shard {
    std::mutex opening;
    std::shared_ptr<const ShardPages> pages;
  };
  struct Entry {
    std::shared_ptr<Shard> shard;
    std::list<std::uint32_t>::iterator use;
  };
  std::shared_ptr<Shard> entry_of(std::uint32_t cell);
  std::shared_ptr<const ShardPages> open(std::uint32_t cell) const;

  std::filesystem::path scene_path_;
  const SceneDescription& scene_;
  std::size_t most_open_;
  std::mutex mutex_;
  std::list<std::uint32_t> uses_;  ///< cells, the last used in front
  std::unordered_map<std::uint32_t, Entry> entries_;
};

}  // namespace gigabake
