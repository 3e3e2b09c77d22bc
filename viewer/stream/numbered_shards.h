/// Lookup of a scene's cells and overviews by the shard numbers of page keys. The scene's pages are read on demand, and
/// a bounded number of them is kept.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>

#include "format/scene/paged_scene.h"
#include "format/system/loading_cache.h"
#include "viewer/stream/page.h"

namespace gigabake {

/// Thread-safe: any number of threads may use the same NumberedShards concurrently.
/// Errors  All members: InputError: unknown number; a page of the scene that cannot be read.
class NumberedShards {
 public:
  /// files_opened: counts the pages read.
  NumberedShards(std::shared_ptr<const PagedScene> scene, std::shared_ptr<std::atomic<std::uint64_t>> files_opened);

  const PagedScene& scene() const { return *scene_; }
  SceneCell shard(std::uint32_t number);
  /// Returns the listing of one page of the scene.
  /// Range   key.part ≤ PageKey::listing.
  Page listing(const PageKey& key);

 private:
  struct Listing {
    std::uint32_t first_cell = 0, first_overview = 0;  ///< first_overview counts overviews only
    std::shared_ptr<const ScenePage> page;
  };
  /// Returns whether the item is in the referenced page or below it. The arguments after it are the page's first cell
  /// and overview.
  using IsBelow =
      std::function<bool(const PageReference& reference, std::uint32_t first, std::uint32_t first_overview)>;
  Listing page_with(const IsBelow& is_below, std::int32_t depth);
  Listing page_with_cell(std::uint32_t cell, std::int32_t depth);
  std::shared_ptr<const ScenePage> read(const PageReference& reference, std::uint32_t first, std::int32_t depth);

  std::shared_ptr<const PagedScene> scene_;
  std::shared_ptr<std::atomic<std::uint64_t>> files_opened_;
  /// Pages by their first cell and their depth.
  LoadingCache<std::uint64_t, ScenePage, std::hash<std::uint64_t>, CostOfEntry> pages_;
};

}  // namespace gigabake
