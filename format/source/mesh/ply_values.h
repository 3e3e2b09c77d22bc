/// The values behind the header of a PLY, one after the other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "format/source/mesh/ply_header.h"

namespace gigabake {

/// Errors (all)  InputError with the line (ASCII) or the byte: the file ends, or a word is no number.
class PlyValues {
 public:
  /// All of them outlive it.
  PlyValues(const std::filesystem::path& file, std::span<const std::uint8_t> bytes, const PlyHeader& header)
      : file_(file), bytes_(bytes), format_(header.format), at_(header.bytes), line_(header.lines + 1) {}

  /// Exact  every type of PLY is a double.
  double number(PlyType type) { return format_ == PlyFormat::ascii ? word() : binary(type); }

  /// The length of a list, whose items the file has room for.
  std::uint64_t length(const PlyProperty& list);

  /// Reads over a property, a list too.
  void skip(const PlyProperty& property);

  /// Refuses an element that says it has more items than the file has room for: ask before anything is allocated.
  void expect_room_for(const PlyElement& element) const;

  [[noreturn]] void fail(const std::string& message) const;

 private:
  double word();
  double binary(PlyType type);
  std::uint64_t left() const { return bytes_.size() - at_; }

  const std::filesystem::path& file_;
  std::span<const std::uint8_t> bytes_;
  PlyFormat format_;
  std::size_t at_, line_;
};

}  // namespace gigabake
