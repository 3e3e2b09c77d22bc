/// A scene's cells and parents by the numbers that pages' keys know them by: looked up in the scene's pages, of which
/// a bounded number is kept.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>

#include "format/scene/paged_scene.h"
#include "viewer/stream/page.h"

namespace gigabake {

/// Any number of threads may use one at a time.
/// Errors (all)  InputError: no such number; a page of the scene that cannot be read.
class NumberedShards {
 public:
  /// files_opened: counts pages that are read.
  NumberedShards(std::shared_ptr<const PagedScene> scene, std::shared_ptr<std::atomic<std::uint64_t>> files_opened);

  const PagedScene& scene() const { return *scene_; }
  SceneCell shard(std::uint32_t number);
  /// Range  key.part ≤ PageKey::listing.
  Page listing(const PageKey& key);

 private:
  struct Kept {
    std::uint32_t first = 0;
    std::int32_t depth = 0;
    std::shared_ptr<const ScenePage> page;
  };
  struct Listing {
    std::uint32_t first_cell = 0, first_parent = 0;  ///< the latter counted from 0
    std::shared_ptr<const ScenePage> page;
  };
  /// Whether what is looked for stands in the page that is meant or below it, whose first cell and parent are given.
  using IsBelow = std::function<bool(const PageReference& reference, std::uint32_t first, std::uint32_t first_parent)>;
  Listing page_with(const IsBelow& is_below, std::int32_t depth);
  Listing page_with_cell(std::uint32_t cell, std::int32_t depth);
  std::shared_ptr<const ScenePage> read(const PageReference& reference, std::uint32_t first, std::int32_t depth);

  std::shared_ptr<const PagedScene> scene_;
  std::shared_ptr<std::atomic<std::uint64_t>> files_opened_;
  std::mutex mutex_;
  std::list<Kept> kept_;  ///< the last used in front
};

}  // namespace gigabake
