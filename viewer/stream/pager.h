/// The pages in memory: read by threads of its own, most urgent first; the longest unused let go.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "viewer/stream/page.h"

namespace gigabake {

struct PagerCounts {
  std::uint64_t reads = 0;       ///< pages read, each time anew
  std::uint64_t bytes = 0;       ///< of the pages here now
  std::uint64_t peak_bytes = 0;  ///< most at once
  std::uint64_t queued = 0;      ///< wanted, not read yet, those being read included
  std::uint64_t bytes_read = 0;  ///< of all pages read so far
};

/// One thread calls it, but for find().
class Pager {
 public:
  struct Options {
    int threads = 2;                                      ///< readers and decoders
    std::uint64_t memory_bytes = std::uint64_t(1) << 29;  ///< UINT64_MAX: no bound
  };

  Pager(PageSource source, const Options& options);
  ~Pager();  ///< waits for the pages being read

  /// Takes in what has arrived and makes room: pages that nobody found since the last call go, the longest unused
  /// first, until the rest keeps within memory_bytes. What has arrived stays until the pass ends. So memory exceeds the
  /// bound only by what one pass needs at once and by the pages being read.
  /// Returns whether anything arrived, damage included.
  bool begin_pass();

  /// Null where it is not here. Marks it as used. Valid until the next begin_pass(), and so is the answer null. Any
  /// number of threads, without a lock, beside everything but begin_pass().
  const Page* find(const PageKey& key) const;

  /// Nothing to wait for: the page cannot be read. It is not tried again. Threads as find().
  bool is_damaged(const PageKey& key) const;

  /// Replaces what was wanted before; pages that are being read go on. Those here or damaged are skipped, and those
  /// that would not fit beside what the last pass used, but for the first, wait for a later call. To be called at the
  /// end of a pass: what it has not found by now may make room before the next one begins.
  void want(const std::vector<PageKey>& most_urgent_first);

  /// Until something has arrived for begin_pass(), or nothing is queued. False: the time was over before.
  bool wait(std::chrono::milliseconds most = std::chrono::hours(1));

  /// Until nothing is queued. False: the time was over before.
  bool settle(std::chrono::milliseconds most);
  /// Whether begin_pass() would take something in.
  bool has_arrivals() const;

  PagerCounts counts() const;

  /// One line for each page that could not be read, and why; lines that are the same once.
  std::vector<std::string> problems() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
