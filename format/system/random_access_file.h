/// A file that is written in any order and can be read back while it is incomplete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "format/system/descriptor.h"

namespace gigabake {

/// A random-access output file.
/// Errors  Every member throws InputError with `target` and the system's reason.
class RandomAccessFile {
 public:
  /// Opens the existing file `temporary` and sets its size to `bytes`; unwritten parts are zero.
  RandomAccessFile(std::filesystem::path target, const std::filesystem::path& temporary, std::uint64_t bytes);

  void write(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  void read(std::uint64_t offset, std::span<std::uint8_t> bytes) const;

  template <class T>
  void write_value(std::uint64_t offset, const T& value) {
    write(offset, {reinterpret_cast<const std::uint8_t*>(&value), sizeof(T)});
  }
  template <class T>
  void read_value(std::uint64_t offset, T& value) const {
    read(offset, {reinterpret_cast<std::uint8_t*>(&value), sizeof(T)});
  }

 private:
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path target_;
  Descriptor file_;
};

}  // namespace gigabake
