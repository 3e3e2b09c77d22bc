/// A page cache with reader threads. It reads the most urgent requests first and evicts the least recently used pages.
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
  std::uint64_t bytes = 0;       ///< of resident and arrived pages
  std::uint64_t peak_bytes = 0;  ///< max of `bytes` so far
  std::uint64_t queued = 0;      ///< requested but not read yet, including pages being read
  std::uint64_t bytes_read = 0;  ///< sum over all pages read so far
};

/// All members but find(), is_resident() and is_damaged() must be called from one thread.
class Pager {
 public:
  struct Options {
    int threads = 2;                                      ///< readers and decoders
    std::uint64_t memory_bytes = std::uint64_t(1) << 29;  ///< UINT64_MAX: no limit
  };

  Pager(PageSource source, const Options& options);
  ~Pager();  ///< waits for the pages being read

  /// Makes arrived pages resident, then evicts pages until memory_bytes suffice. Evicts only pages that find() has not
  /// returned since the last call, the least recently used first. Arrived pages stay until the pass ends. Memory
  /// exceeds the limit only by the pages that one pass uses and by the pages being read.
  /// Returns whether anything arrived, including damaged pages.
  bool begin_pass();

  /// Returns a page and marks it as used; null if the page is not resident. The result, also null, is valid until the
  /// next begin_pass(). Any number of threads may call find() without a lock, but not concurrently with begin_pass().
  const Page* find(const PageKey& key) const;

  /// Returns whether the page is resident, without marking it as used. Threads may call is_resident() like find().
  bool is_resident(const PageKey& key) const;

  /// Returns whether the page cannot be read; a damaged page is not read again. Threads may call is_damaged() like
  /// find().
  bool is_damaged(const PageKey& key) const;

  /// Replaces the request queue; pages being read are completed. Skips pages that are resident or damaged. Except for
  /// the first request, a page is read only if it fits in memory next to the pages that the last pass used. Call
  /// request() at the end of a pass: pages that find() has not returned by then may be evicted before the next pass
  /// begins.
  void request(const std::vector<PageKey>& by_urgency);

  /// Waits until something has arrived for begin_pass(), or nothing is queued. Returns false on timeout.
  bool wait(std::chrono::milliseconds maximum = std::chrono::hours(1));

  /// Waits until nothing is queued. Returns false on timeout.
  bool settle(std::chrono::milliseconds maximum);
  /// Returns whether begin_pass() would make a page resident or mark one as damaged.
  bool has_loaded_pages() const;

  /// Returns whether pages take most of the memory, or were evicted in the last passes. Pages that find() has not
  /// returned in this pass may then be evicted before the next pass.
  bool may_evict() const;

  PagerCounts counts() const;

  /// Returns one line per page that could not be read, with the reason; equal lines appear once.
  std::vector<std::string> problems() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
