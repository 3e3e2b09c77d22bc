/// Resident pages, each with the last pass in which it was found. Lookups need no lock, even during eviction. A page's
/// timestamp is either its last pass or `evicted`. An atomic exchange decides whether find() or evict() sets the
/// timestamp first.
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

/// A container of pages. Only find() may run concurrently with other members, except begin_pass() and add(). All other
/// members require external synchronization.
class ResidentPages {
 public:
  /// Returns the page; null if it is not resident. A page that was found stays until the next begin_pass().
  const Page* find(const PageKey& key) const;
  bool has(const PageKey& key) const;  ///< does not mark the page as used

  /// Frees evicted pages and begins a new pass.
  void begin_pass();
  /// Inserts a page as if it was last used in the previous pass. Call add() after begin_pass() and before the first
  /// find() of the pass.
  void add(const PageKey& key, Page page, std::uint64_t page_bytes);

  /// Lists the pages that find() has not returned in this pass. They are the candidates of evict() until the list is
  /// replaced by list_unused() or list_none().
  void list_unused();
  void list_none();
  /// Evicts candidates, least recently used first, until resident pages take at most `bytes` or no candidate is left. A
  /// candidate that was found after it was listed stays.
  void evict(std::uint64_t bytes);

  /// Returns whether pages were evicted in this pass or in the `passes` passes before it.
  bool has_evicted_within(std::uint64_t passes) const {
    return last_eviction_ != 0 && pass_ - last_eviction_ <= passes;
  }

  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t candidate_bytes() const { return candidate_bytes_; }

 private:
  static constexpr std::uint64_t evicted = std::numeric_limits<std::uint64_t>::max();

  struct Resident {
    Resident(Page its_page, std::uint64_t its_bytes, std::uint64_t last_used)
        : page(std::move(its_page)), bytes(its_bytes), used(last_used) {}
    Page page;
    std::uint64_t bytes;
    mutable std::atomic<std::uint64_t> used;  ///< last pass in which the page was found, or `evicted`
  };
  struct Candidate {
    std::uint64_t used;
    PageKey key;
    Resident* resident;
  };
  static bool is_more_recent(const Candidate& a, const Candidate& b);

  std::uint64_t pass_ = 0, bytes_ = 0, candidate_bytes_ = 0;
  std::uint64_t last_eviction_ = 0;  ///< its pass; 0: none yet
  std::unordered_map<PageKey, Resident, PageKeyHash> residents_;
  std::vector<Candidate> candidates_;  ///< heap, least recently used on top
  std::vector<PageKey> evicted_;
};

}  // namespace gigabake
