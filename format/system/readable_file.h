/// A file that is read by ranges, for what need not be in memory whole. It is not mapped: where another program cuts a
/// mapped file short, the system ends its readers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "format/system/descriptor.h"

namespace gigabake {

/// Threads may share one. Errors  InputError of every member.
class ReadableFile {
 public:
  /// Errors  no such file, not a regular file, cannot be opened.
  explicit ReadableFile(std::filesystem::path path);

  /// As it was opened.
  std::uint64_t bytes() const { return bytes_; }
  /// Errors  it has been cut since it was opened, or cannot be read there.
  void read(std::uint64_t offset, std::span<std::uint8_t> out) const;

 private:
  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t bytes_ = 0;
};

}  // namespace gigabake
