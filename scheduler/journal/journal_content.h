/// Content of a journal: the reports of cells that earlier bakes into the same folder finished, by fingerprint.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

/// One record: a finished cell and its report.
struct JournalEntry {
  Hash128 fingerprint;
  std::string cell;  ///< CellJob::name; the report of an empty cell has no name
  CellReport report;
};

/// Returns the bytes of one record: magic (u32), size of the payload in bytes (u32), XXH3 of the payload (u64),
/// payload.
std::vector<std::uint8_t> journal_record(const JournalEntry& entry);
/// Returns the header of a journal: format and version, as text.
std::string_view journal_header();

/// A journal's bytes and an index of its records. Later records of a fingerprint replace earlier ones.
/// Cost    Takes 900 bytes of memory per cell. A report is decoded when find() returns it.
/// Errors  None: reading stops at the first record that is truncated, damaged or of another format; a file with another
///         header counts as empty.
class JournalContent {
 public:
  JournalContent() = default;
  explicit JournalContent(std::vector<std::uint8_t> file);
  JournalContent(JournalContent&&) = default;  // no copy: the names in a copy would point into the original's bytes
  JournalContent& operator=(JournalContent&&) = default;

  std::optional<CellReport> find(const Hash128& fingerprint) const;
  /// Visits the last record of each fingerprint, in the order of the file. Skips records of other program versions.
  void for_each(const std::function<void(const Hash128&, const CellReport&)>& visit) const;
  /// Returns true if there is a record of this cell name with any fingerprint.
  bool knows_cell(std::string_view name) const { return cells_.contains(name); }

  std::size_t records() const { return records_; }
  std::size_t fingerprints() const { return payloads_.size(); }
  /// Returns the size of header and complete records; 0 if the header differs.
  std::uint64_t whole_bytes() const { return whole_bytes_; }
  /// Returns true if later records have replaced more than half of all records.
  bool is_wasteful() const { return records_ > 2 * payloads_.size(); }
  /// Returns a journal with the last record of each fingerprint for which `wanted` returns true.
  std::vector<std::uint8_t> compacted(const std::function<bool(const Hash128&)>& wanted) const;

 private:
  /// Location of a payload in bytes_.
  struct Place {
    std::size_t at, bytes;
  };
  struct LowHalf {
    std::size_t operator()(const Hash128& h) const { return std::size_t(h.lo); }
  };

  std::optional<Place> record_at(std::size_t at) const;
  bool take(const Place& place);
  std::optional<CellReport> report_at(const Place& place) const;
  std::vector<std::pair<Place, Hash128>> in_file_order() const;

  std::vector<std::uint8_t> bytes_;
  std::unordered_map<Hash128, Place, LowHalf> payloads_;
  std::unordered_set<std::string_view> cells_;  ///< views into bytes_
  std::size_t records_ = 0;
  std::uint64_t whole_bytes_ = 0;
};

/// Reads the complete records of a journal that another process may be writing. Returns an empty journal if there is no
/// file.
/// Errors  InputError: the file exists but cannot be read.
JournalContent read_journal(const std::filesystem::path& path);

}  // namespace gigabake
