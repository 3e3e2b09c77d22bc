/// Pages of cells whose shards appear while a viewer shows them. A cell without a shard has the pages of an empty tree.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "core/base/lru_cache.h"
#include "format/scene/paged_scene.h"
#include "format/shard/shard_pages.h"
#include "viewer/stream/page.h"

namespace gigabake {

/// Thread-safe.
class WatchedShards {
 public:
  /// Takes the cells of a scene without pages and overviews. A cell without `file` has no shard. Keeps at most
  /// `max_open` shards open.
  WatchedShards(const PagedScene& scene, std::size_t max_open);

  /// Replaces a cell's shard.
  /// Range   The cell has the place that the cell with this number had.
  void replace(std::uint32_t number, const SceneCell& cell);

  /// Returns a page of the cell's current shard.
  /// Errors  The errors of PageSource.
  Page page(const PageKey& key);

 private:
  using Pages = std::shared_ptr<const ShardPages>;
  Pages open(const SceneCell& cell) const;
  Pages shard(std::uint32_t number);

  const std::filesystem::path folder_;
  const SceneHeader header_;
  std::mutex mutex_;  ///< guards the members below
  std::vector<SceneCell> cells_;
  LruCache<std::uint32_t, Pages> shards_;
};

}  // namespace gigabake
