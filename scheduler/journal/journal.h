/// OUT/journal: an append-only log of finished cells, so that the next bake need not read each shard.
///
/// The journal is only a cache. If it or its end is lost, workers read the affected shards again. A record of a shard
/// is trusted only together with the shard's stamp (scheduler/journal/cached_results.h).
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>

#include "format/system/descriptor.h"
#include "scheduler/journal/journal_content.h"

namespace gigabake {

/// Writer of the journal; the lock of OUT ensures that there is only one.
class Journal {
 public:
  /// Opens the journal on the first append(), which truncates an incomplete record at the end. If more than half of the
  /// records are superseded, rewrites the file without them here. so_far: read_journal(path).
  /// Errors  InputError.
  Journal(std::filesystem::path path, const JournalContent& so_far);
  /// Syncs. Records that cannot be synced may be lost; the next bake then validates their shards.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Writes the record immediately; flushes to disk at the 64th record or the first after 200 ms. Skips failed cells
  /// because they are not done.
  /// Errors  InputError on the first failure; later calls do nothing. The bake can continue.
  void append(const CellJob& job, const CellReport& report);
  /// Flushes the written records to disk.
  /// Errors  InputError on the first failure, as append().
  void sync();
  /// Drops the records of all other cells, for example after their shards were removed.
  /// Errors  InputError: the journal is unchanged.
  void keep_only(const std::vector<CellJob>& jobs);

  /// Returns the number of records that a power failure may lose.
  std::size_t unsynced() const { return unsynced_; }

 private:
  using Clock = std::chrono::steady_clock;

  void open();
  void rewrite(const std::vector<std::uint8_t>& content);
  [[noreturn]] void give_up(const char* what);

  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t bytes_;  ///< header and complete records
  bool has_failed_ = false;
  std::size_t unsynced_ = 0;
  Clock::time_point first_unsynced_;
};

}  // namespace gigabake
