/// A file that is read by ranges, so that it need not fit in memory. It is not memory-mapped, because truncation of a
/// mapped file by another program kills its readers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "format/system/descriptor.h"

namespace gigabake {

/// A file for random reads. Thread-safe.
/// Errors  Every member throws InputError.
class ReadableFile {
 public:
  /// Errors  InputError if the file does not exist, is not a regular file, or cannot be opened.
  explicit ReadableFile(std::filesystem::path path);

  /// Returns the size at the time of opening.
  std::uint64_t bytes() const { return bytes_; }
  /// Reads out.size() bytes from `offset` on.
  /// Errors  InputError if the file was truncated after opening, or the bytes cannot be read.
  void read(std::uint64_t offset, std::span<std::uint8_t> out) const;

 private:
  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t bytes_ = 0;
};

}  // namespace gigabake
