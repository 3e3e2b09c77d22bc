/// A file of an export that is written sequentially.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "format/system/descriptor.h"

namespace gigabake {

/// A buffered output file.
/// Errors  Every member throws InputError with `target` (the path of the export), the name of the file, and the
///         system's reason.
class OutputFile {
 public:
  /// Creates the file and its parent folders.
  OutputFile(std::filesystem::path target, const std::filesystem::path& file);

  void write(std::span<const std::uint8_t> bytes);
  void write(std::string_view text) { write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}); }
  /// Writes the value in little endian, without padding between calls.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { write({reinterpret_cast<const std::uint8_t*>(&value), sizeof(T)}); }
  /// Writes the buffered bytes and closes the file. Call it after the last write(); otherwise the buffered bytes are
  /// lost.
  void finish();

 private:
  void flush();
  [[noreturn]] void fail() const;

  std::filesystem::path target_, name_;
  Descriptor file_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace gigabake
