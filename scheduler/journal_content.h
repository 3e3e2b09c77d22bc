/// What a journal says: the cells that earlier bakes into a folder finished, by fingerprint.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

/// One record: what was baked under which name, and what came of it.
struct JournalEntry {
  Hash128 fingerprint;
  std::string cell;  ///< CellJob::name; the report of an empty cell has none
  CellReport report;
};

/// The record of one entry, as it is appended: u32 magic, u32 bytes of the payload, u64 XXH3 of it, payload.
std::vector<std::uint8_t> journal_record(const JournalEntry& entry);
/// What a journal begins with: format and version, in letters.
std::string_view journal_header();

/// A journal's bytes and where its records are in them. Later records of a fingerprint replace earlier ones.
/// Cost    900 bytes a cell; reports are decoded when asked for.
/// Errors  None: the records end at the first that is torn, damaged or foreign, and a file with another header has
/// none.
class JournalContent {
 public:
  JournalContent() = default;
  explicit JournalContent(std::vector<std::uint8_t> file);
  JournalContent(JournalContent&&) = default;  // a copy's names would stand in the original's bytes
  JournalContent& operator=(JournalContent&&) = default;

  std::optional<CellReport> find(const Hash128& fingerprint) const;
  /// Under whatever fingerprint.
  bool knows_cell(std::string_view name) const { return cells_.contains(name); }

  std::size_t records() const { return records_; }
  std::size_t fingerprints() const { return payloads_.size(); }
  /// Header and whole records; 0 where the header is another one.
  std::uint64_t whole_bytes() const { return whole_bytes_; }
  /// More than half of it has been replaced by later records.
  bool is_wasteful() const { return records_ > 2 * payloads_.size(); }
  /// A journal of the last record of each fingerprint that is `wanted`.
  std::vector<std::uint8_t> compacted(const std::function<bool(const Hash128&)>& wanted) const;

 private:
  /// A payload in bytes_.
  struct Place {
    std::size_t at, bytes;
  };
  struct LowHalf {
    std::size_t operator()(const Hash128& h) const { return std::size_t(h.lo); }
  };

  std::optional<Place> record_at(std::size_t at) const;
  bool take(const Place& place);

  std::vector<std::uint8_t> bytes_;
  std::unordered_map<Hash128, Place, LowHalf> payloads_;
  std::unordered_set<std::string_view> cells_;  ///< in bytes_
  std::size_t records_ = 0;
  std::uint64_t whole_bytes_ = 0;
};

/// Of a journal that somebody else may be writing: what is whole by now. Empty where there is none.
/// Errors  InputError: the file is there and cannot be read.
JournalContent read_journal(const std::filesystem::path& path);

}  // namespace gigabake
