/// Resident pages, each with the pass that found it last. Lookups need no lock, even during eviction. A page's
/// timestamp contains either its last pass or `gone`, and an atomic exchange decides which of the two is written.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "viewer/stream/page.h"

namespace gigabake {

struct PageKeyHash {
  std::size_t operator()(const PageKey& key) const;
};

/// All members but find() must be called from one thread. find() may run concurrently with all but begin_pass() and
/// add().
class ResidentPages {
 public:
  /// Returns null if the page is not resident. A page that was found stays until the next begin_pass().
  const Page* find(const PageKey& key) const;
  bool has(const PageKey& key) const;  ///< does not mark it as used

  /// Frees evicted pages and begins a new pass.
  void begin_pass();
  /// Inserts a page as last used in the previous pass. Call it between begin_pass() and the pass.
  void add(const PageKey& key, Page page, std::uint64_t page_bytes);

  /// Lists the pages that this pass has not found so far: the candidates of evict(), until the next call.
  void list_unused();
  void list_none();
  /// Evicts candidates, least recently used first, until resident pages take at most `bytes` or no candidate is left. A
  /// candidate that was found after it was listed stays.
  void evict(std::uint64_t bytes);

  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t candidate_bytes() const { return candidate_bytes_; }

 private:
  static constexpr std::uint64_t gone = std::numeric_limits<std::uint64_t>::max();

  struct Resident {
    Resident(Page its_page, std::uint64_t its_bytes, std::uint64_t last_used)
        : page(std::move(its_page)), bytes(its_bytes), used(last_used) {}
    Page page;
    std::uint64_t bytes;
    mutable std::atomic<std::uint64_t> used;  ///< last pass that found it, or `gone`
  };
  struct Candidate {
    std::uint64_t used;
    PageKey key;
    Resident* resident;
  };
  static bool is_more_recent(const Candidate& a, const Candidate& b);

  std::uint64_t pass_ = 0, bytes_ = 0, candidate_bytes_ = 0;
  std::unordered_map<PageKey, Resident, PageKeyHash> residents_;
  std::vector<Candidate> candidates_;  ///< heap, least recently used on top
  std::vector<PageKey> gone_;
};

}  // namespace gigabake
