/// OUT/journal (OUT is the bake's folder): an append-only log of finished cells, so that the next bake need not read
/// each shard.
///
/// The journal is only a cache. If the journal or its last records are lost, workers read the affected shards again. A
/// record of a shard is trusted only together with the shard's stamp (scheduler/journal/cached_results.h).
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>

#include "format/system/descriptor.h"
#include "scheduler/journal/journal_content.h"

namespace gigabake {

/// Writer of the journal; the lock of OUT ensures that there is only one writer.
class Journal {
 public:
  /// Rewrites the file without superseded records if more than half of the records are superseded. The first append()
  /// opens the file and truncates an incomplete record at its end. `so_far` is read_journal(path).
  /// Errors  InputError if the file cannot be rewritten.
  Journal(std::filesystem::path path, const JournalContent& so_far);
  /// Flushes the written records to disk. Records that cannot be flushed may be lost; the next bake then validates
  /// their shards.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Writes the job's record immediately. Flushes the records to disk if 64 records are not flushed, or the oldest of
  /// these was written 200 ms ago. Skips failed cells because they are not done.
  /// Errors  InputError on the first failure; later calls do nothing. The bake can continue.
  void append(const CellJob& job, const CellReport& report);
  /// Flushes the written records to disk.
  /// Errors  InputError on the first failure, as append().
  void sync();
  /// Removes the records of all cells that are not in `jobs`, for example after their shards were removed.
  /// Errors  InputError if the file cannot be read or rewritten; the journal is then unchanged.
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
  std::uint64_t bytes_;  ///< size of the header and the complete records
  bool has_failed_ = false;
  std::size_t unsynced_ = 0;
  Clock::time_point first_unsynced_;
};

}  // namespace gigabake
