/// A file of an export that is written from its begin to its end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "format/system/descriptor.h"

namespace gigabake {

/// Errors  InputError of every member: `target`, the export that messages name, the file in it and the system's reason.
class OutputFile {
 public:
  /// Makes the file, and folders on the way to it.
  OutputFile(std::filesystem::path target, const std::filesystem::path& file);

  void write(std::span<const std::uint8_t> bytes);
  void write(std::string_view text) { write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}); }
  /// Little endian, without padding between the calls.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { write({reinterpret_cast<const std::uint8_t*>(&value), sizeof(T)}); }
  /// To be called after the last byte: what is buffered is lost otherwise.
  void finish();

 private:
  void flush();
  [[noreturn]] void fail() const;

  std::filesystem::path target_, name_;
  Descriptor file_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace gigabake
