/// A scene's cells and parents by the numbers that pages' keys know them by: looked up in the scene's pages, of which
/// a bounded number is kept.
#pragma once

#include <atomic>
#include <cstdint>
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
  Kept page_with(std::uint32_t cell, std::int32_t depth);
  std::shared_ptr<const ScenePage> read(const PageReference& reference, std::uint32_t first, std::int32_t depth);

  std::shared_ptr<const PagedScene> scene_;
  std::shared_ptr<std::atomic<std::uint64_t>> files_opened_;
  std::mutex mutex_;
  std::list<Kept> kept_;  ///< the last used in front
};

}  // namespace gigabake
