/// The pages that one thread has found during a pass of the pager.
#pragma once

#include <array>
#include <cstddef>

#include "viewer/stream/page.h"
#include "viewer/stream/resident_pages.h"

namespace gigabake {

/// A cache of Pager::find(), which reads several cache lines that other threads may have changed. Pages with the same
/// hash replace each other. It is valid for one pass of the pager.
class FoundPages {
 public:
  /// Returns the page; null if it is not in the cache.
  const Page* find(const PageKey& key) const {
    const Entry& entry = entries_[place_of(key)];
    return entry.key == key ? entry.page : nullptr;
  }
  void add(const PageKey& key, const Page* page) { entries_[place_of(key)] = {key, page}; }

 private:
  static constexpr std::size_t size = 256;

  struct Entry {
    PageKey key;
    const Page* page = nullptr;
  };

  static std::size_t place_of(const PageKey& key) { return PageKeyHash()(key) % size; }

  std::array<Entry, size> entries_;
};

}  // namespace gigabake
