/// Page cache with its own reader threads: most urgent requests first, eviction of the least recently used pages.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "viewer/stream/page.h"

namespace gigabake {

struct PagerCounts {
  std::uint64_t reads = 0;       ///< pages read; a page read again counts again
  std::uint64_t bytes = 0;       ///< of the resident pages
  std::uint64_t peak_bytes = 0;  ///< max of `bytes` so far
  std::uint64_t queued = 0;      ///< requested but not read yet, including pages being read
  std::uint64_t bytes_read = 0;  ///< of all pages read so far
};

/// All members but find() and is_damaged() must be called from one thread.
class Pager {
 public:
  struct Options {
    int threads = 2;                                      ///< readers and decoders
    std::uint64_t memory_bytes = std::uint64_t(1) << 29;  ///< UINT64_MAX: no limit
  };

  Pager(PageSource source, const Options& options);
  ~Pager();  ///< waits for the pages being read

  /// Makes arrived pages resident and evicts pages that were not found since the last call, least recently used first,
  /// until memory_bytes suffice. Arrived pages stay until the pass ends. Memory exceeds the limit only by what one pass
  /// needs at once and by the pages being read.
  /// Returns whether anything arrived, including damaged pages.
  bool begin_pass();

  /// Returns a page and marks it as used, or returns null if it is not resident. The result, also null, is valid until
  /// the next begin_pass(). Any number of threads may call it without a lock, but not concurrently with begin_pass().
  const Page* find(const PageKey& key) const;

  /// Returns whether the page cannot be read; it is not tried again. Threads may call it like find().
  bool is_damaged(const PageKey& key) const;

  /// Replaces the request queue; pages being read are completed. Skips pages that are resident or damaged. Except for
  /// the first request, pages that do not fit next to those that the last pass used are left to a later call. Call it
  /// at the end of a pass: pages not found by then may be evicted before the next pass begins.
  void want(const std::vector<PageKey>& by_urgency);

  /// Waits until something has arrived for begin_pass(), or nothing is queued. Returns false on timeout.
  bool wait(std::chrono::milliseconds maximum = std::chrono::hours(1));

  /// Waits until nothing is queued. Returns false on timeout.
  bool settle(std::chrono::milliseconds maximum);
  /// Returns whether begin_pass() would make a page resident or mark one as damaged.
  bool has_arrivals() const;

  PagerCounts counts() const;

  /// Returns one line per page that could not be read, with the reason; equal lines appear once.
  std::vector<std::string> problems() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
