/// The values behind the header of a PLY, one after the other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/source/mesh/ply_header.h"
#include "format/source/source_bytes.h"

namespace gigabake {

/// Cost          A block of the file is in memory.
/// Errors (all)  InputError with the line (ASCII) or the byte: the file ends, or a word is no number.
class PlyValues {
 public:
  /// `file` and `header` outlive it.
  PlyValues(const std::filesystem::path& file, SourceBytes bytes, const PlyHeader& header)
      : file_(file), bytes_(std::move(bytes)), format_(header.format), at_(header.bytes), line_(header.lines + 1) {}

  /// Exact  every type of PLY is a double.
  double number(PlyType type) { return format_ == PlyFormat::ascii ? word() : binary(type); }

  /// The length of a list, whose items the file has room for.
  std::uint64_t length(const PlyProperty& list);

  /// Reads over a property, a list too.
  void skip(const PlyProperty& property);

  /// Refuses an element that says it has more items than the file has room for: ask before anything is allocated.
  void expect_room_for(const PlyElement& element) const;

  [[noreturn]] void fail(const std::string& message) const;

  /// Where in the file the value is that was read last: "line 12" or "byte 345", made a text only if it is needed.
  struct Place {
    bool is_line;
    std::uint64_t at;
    operator std::string() const { return (is_line ? "line " : "byte ") + std::to_string(at); }
  };
  Place place() const { return format_ == PlyFormat::ascii ? Place{true, line_} : Place{false, at_}; }

 private:
  double word();
  double binary(PlyType type);
  std::uint64_t left() const { return bytes_.size() - at_; }
  /// Makes `bytes` bytes from at_ on available in block_, or all that are left. Returns how many there are.
  std::size_t make_available(std::size_t bytes);
  std::uint8_t byte_at(std::uint64_t i) const { return block_[std::size_t(i - block_begin_)]; }

  const std::filesystem::path& file_;
  SourceBytes bytes_;
  PlyFormat format_;
  std::uint64_t at_;
  std::size_t line_;
  std::vector<std::uint8_t> room_;
  std::span<const std::uint8_t> block_;
  std::uint64_t block_begin_ = 0;
};

}  // namespace gigabake
