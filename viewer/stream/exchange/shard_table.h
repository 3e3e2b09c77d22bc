/// Pages of shards that are added and replaced while a viewer shows them. A shard keeps its number until it is
/// replaced, so its pages stay valid when others are replaced.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "core/base/lru_cache.h"
#include "format/scene/paged_scene.h"
#include "format/shard/shard_pages.h"
#include "viewer/stream/page.h"

namespace gigabake {

/// The numbers of a scene's shards in a table.
struct ShardNumbers {
  std::vector<std::uint32_t> cells, overviews;  ///< in the order of the scene's lists; empty if the scene has pages
  /// The numbers of replaced shards of a scene with pages, by PageKey::shard. Other shards keep this number.
  std::unordered_map<std::uint32_t, std::uint32_t> replaced = {};

  std::uint32_t of_paged(std::uint32_t shard) const {
    const auto found = replaced.find(shard);
    return found == replaced.end() ? shard : found->second;
  }
};

/// Thread-safe.
class ShardTable {
 public:
  /// Opens shards of the scene's folder, and keeps at most `max_open` of them open. Counts each opened shard in
  /// `files_opened`; null: not counted. `chunks` keeps unpacked chunks; null: none are kept.
  ShardTable(const PagedScene& scene, std::size_t max_open,
             std::shared_ptr<std::atomic<std::uint64_t>> files_opened = {}, std::shared_ptr<ChunkCache> chunks = {});

  /// Adds a shard and returns its number. A shard without `file` is an empty tree.
  /// Range   The cell belongs to a scene with the lattice, place and channels of the first scene.
  std::uint32_t add(const SceneCell& shard);
  /// Adds the shards of a scene that lists all of them.
  ShardNumbers add_all(const PagedScene& scene);
  /// Replaces a shard by another file with the same content.
  void replace(std::uint32_t number, const SceneCell& shard);

  /// Returns a page of a shard.
  /// Errors  The errors of PageSource.
  Page page(const PageKey& key);

 private:
  using Pages = std::shared_ptr<const ShardPages>;
  Pages open(const SceneCell& shard) const;
  Pages opened(std::uint32_t number);

  const std::filesystem::path folder_;
  const SceneHeader header_;
  const std::shared_ptr<std::atomic<std::uint64_t>> files_opened_;
  const std::shared_ptr<ChunkCache> chunks_;
  std::mutex mutex_;  ///< guards the members below
  std::vector<SceneCell> shards_;
  LruCache<std::uint32_t, Pages> open_;
};

}  // namespace gigabake
