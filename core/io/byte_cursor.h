/// A reader for the little-endian header of a binary file. Its errors contain the byte offset.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include "core/base/error.h"

namespace gigabake {

/// A cursor over the bytes of a file: `whole` is the file, `rest` the part that is not yet read.
/// Errors  InputError with the byte offset at which the file ends too early.
struct ByteCursor {
  const std::filesystem::path& file;
  std::span<const std::uint8_t> whole, rest;

  std::uint64_t at() const { return std::uint64_t(rest.data() - whole.data()); }
  [[noreturn]] void fail(const std::string& message) const { throw InputError(file, "", message, at()); }

  std::span<const std::uint8_t> take(std::uint64_t bytes, const char* what) {
    if (bytes > rest.size()) fail(std::string("the file ends inside ") + what);
    const std::span<const std::uint8_t> taken = rest.first(bytes);
    rest = rest.subspan(bytes);
    return taken;
  }
  std::uint32_t word(const char* what) {
    std::uint32_t v;
    std::memcpy(&v, take(sizeof v, what).data(), sizeof v);
    return v;
  }
  std::uint64_t long_word(const char* what) {
    std::uint64_t v;
    std::memcpy(&v, take(sizeof v, what).data(), sizeof v);
    return v;
  }
};

}  // namespace gigabake
