/// The pages in memory and the pass that found each last. Finding needs no lock, not even against letting go: a page's
/// stamp says either in which pass it was found or that it is gone, and only one of the two can win.
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

/// One thread at a time calls it, but for find(): that may run beside everything except begin_pass() and add().
class ResidentPages {
 public:
  /// Null where it is not here. Keeps the page until the next begin_pass().
  const Page* find(const PageKey& key) const;
  bool has(const PageKey& key) const;  ///< without keeping it

  /// What has been let go is forgotten; what is found from now on is of a new pass.
  void begin_pass();
  /// As if the last pass had found it. To be called between begin_pass() and the pass.
  void add(const PageKey& key, Page page, std::uint64_t page_bytes);

  /// Lists what the pass has not found so far: the candidates of let_go(), until the next call.
  void list_unused();
  void list_none();
  /// Candidates go, the longest unused first, until those here take no more than `bytes`, or none is left. One that was
  /// found in the meantime stays.
  void let_go(std::uint64_t bytes);

  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t candidate_bytes() const { return candidate_bytes_; }

 private:
  static constexpr std::uint64_t gone = std::numeric_limits<std::uint64_t>::max();

  struct Resident {
    Resident(Page its_page, std::uint64_t its_bytes, std::uint64_t last_used)
        : page(std::move(its_page)), bytes(its_bytes), used(last_used) {}
    Page page;
    std::uint64_t bytes;
    mutable std::atomic<std::uint64_t> used;  ///< the last pass that found it, or gone
  };
  struct Candidate {
    std::uint64_t used;
    PageKey key;
    Resident* resident;
  };
  static bool longer_unused_above(const Candidate& a, const Candidate& b);

  std::uint64_t pass_ = 0, bytes_ = 0, candidate_bytes_ = 0;
  std::unordered_map<PageKey, Resident, PageKeyHash> residents_;
  std::vector<Candidate> candidates_;  ///< a heap, the longest unused on top
  std::vector<PageKey> gone_;
};

}  // namespace gigabake
