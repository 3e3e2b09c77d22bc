/// Lookup of a scene's cells and overviews by the shard numbers of page keys. The scene's pages are read on demand, and
/// a bounded number of pages stays in memory.
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
/// Errors  InputError, from all members: an unknown number, or a page of the scene that cannot be read.
class NumberedShards {
 public:
  /// Takes a counter of the pages that are read, `files_opened`; null: not counted.
  NumberedShards(std::shared_ptr<const PagedScene> scene, std::shared_ptr<std::atomic<std::uint64_t>> files_opened);

  const PagedScene& scene() const { return *scene_; }
  SceneCell shard(std::uint32_t number);
  /// Returns the listing of the scene's page that `key` names.
  /// Range   key.part ≤ PageKey::listing.
  Page listing(const PageKey& key);

 private:
  struct Listing {
    std::uint32_t first_cell = 0, first_overview = 0;  ///< first_overview counts overviews only
    std::shared_ptr<const ScenePage> page;
  };
  /// Returns true if the item is listed in the referenced page or in a page below it. `first` and `first_overview` are
  /// the indices of the page's first cell and first overview.
  using IsBelow =
      std::function<bool(const PageReference& reference, std::uint32_t first, std::uint32_t first_overview)>;
  Listing page_with(const IsBelow& is_below, std::int32_t depth);
  Listing page_with_cell(std::uint32_t cell, std::int32_t depth);
  std::shared_ptr<const ScenePage> read(const PageReference& reference, std::uint32_t first, std::int32_t depth);

  std::shared_ptr<const PagedScene> scene_;
  std::shared_ptr<std::atomic<std::uint64_t>> files_opened_;
  /// Cache of pages by their first cell and their depth.
  LoadingCache<std::uint64_t, ScenePage, std::hash<std::uint64_t>, CostOfEntry> pages_;
};

}  // namespace gigabake
