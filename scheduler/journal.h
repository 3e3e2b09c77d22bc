/// OUT/journal: what was finished, written down while it happens, so that the next bake need not look into each shard.
///
/// The journal saves work and is never the truth: whoever loses it, or its tail, loses the time in which workers read
/// the shards back. What it says of a shard counts only together with the shard's stamp (scheduler/prior.h).
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>

#include "format/system/descriptor.h"
#include "scheduler/journal_content.h"

namespace gigabake {

/// One writer at a time: the lock of OUT sees to that.
class Journal {
 public:
  /// so_far: read_journal(path). Where more than half of it has been replaced it is rewritten without. Else nothing
  /// happens before there is something to write; then what is not whole is cut off. Errors  InputError.
  Journal(std::filesystem::path path, const JournalContent& so_far);
  /// Syncs; what cannot be synced is lost, at the cost of validating its shards.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Written at once, flushed to disk with the 64th record or the first one after 200 ms. Failed cells are not written:
  /// they are not done.
  /// Errors  InputError, once: from then on nothing is written and nothing fails. The bake can go on.
  void append(const CellJob& job, const CellReport& report);
  /// Errors  InputError, once, as append().
  void sync();
  /// Drops the records of all other cells, as after their shards were removed. Errors  InputError: it is as it was.
  void keep_only(const std::vector<CellJob>& jobs);

  /// Records that a power cut may take.
  std::size_t unsynced() const { return unsynced_; }

 private:
  using Clock = std::chrono::steady_clock;

  void open();
  void rewrite(const std::vector<std::uint8_t>& content);
  [[noreturn]] void give_up(const char* what);

  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t bytes_;  ///< whole records, and the header
  bool gave_up_ = false;
  std::size_t unsynced_ = 0;
  Clock::time_point first_unsynced_;
};

}  // namespace gigabake
