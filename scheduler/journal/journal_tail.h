/// Reader that follows a journal while a bake appends to it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "scheduler/journal/journal_content.h"

namespace gigabake {

class JournalTail {
 public:
  explicit JournalTail(std::filesystem::path path) : path_(std::move(path)) {}

  /// Visits the complete records that were appended since the previous call, in the order of the file. Visits all
  /// records again if the journal was rewritten. A missing file has no records.
  /// Errors  InputError: the file exists but cannot be read.
  void read_new(const std::function<void(const Hash128& fingerprint, const CellReport& report)>& visit);

 private:
  std::filesystem::path path_;
  std::uint64_t inode_ = 0, at_ = 0;
};

}  // namespace gigabake
