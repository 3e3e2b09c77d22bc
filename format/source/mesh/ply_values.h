/// Sequential reader of the values after the header of a PLY.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/source/content/source_bytes.h"
#include "format/source/mesh/ply_header.h"

namespace gigabake {

/// A reader of values in the order of the file.
/// Cost          One block of the file is in memory.
/// Errors (all)  InputError with the line (ASCII) or the byte: the file ends early, or a word is not a number.
class PlyValues {
 public:
  /// Begins after the header. `file` must outlive the object.
  PlyValues(const std::filesystem::path& file, SourceBytes bytes, const PlyHeader& header)
      : file_(file), bytes_(std::move(bytes)), format_(header.format), at_(header.bytes), line_(header.lines + 1) {}

  /// Reads one value.
  /// Exact   A double represents each value of a binary PLY exactly.
  double number(PlyType type) { return format_ == PlyFormat::ascii ? word() : binary(type); }

  /// Reads the length of a list. Throws InputError if the rest of the file cannot hold its items.
  std::uint64_t length(const PlyProperty& list);

  /// Skips a property, which may be a list.
  void skip(const PlyProperty& property);

  /// Throws InputError if the rest of the file cannot hold the declared number of items of an element. Must be called
  /// before memory for the element is allocated.
  void expect_room_for(const PlyElement& element) const;

  /// Returns the number of bytes after the last value. In an ASCII file, the blanks after the value are not counted.
  std::uint64_t bytes_after();

  [[noreturn]] void fail(const std::string& message) const;

  /// The position in the file after the last value: "line 12" or "byte 345". The text is created only if needed.
  struct Place {
    bool is_line;
    std::uint64_t at;
    operator std::string() const { return (is_line ? "line " : "byte ") + std::to_string(at); }
  };
  Place place() const { return format_ == PlyFormat::ascii ? Place{true, line_} : Place{false, at_}; }

 private:
  double word();
  /// Moves to the beginning of the next word. Returns the number of bytes in block_ from there on.
  std::size_t skip_blanks();
  double binary(PlyType type);
  std::uint64_t left() const { return bytes_.size() - at_; }
  /// Loads at least min(`bytes`, left()) bytes from at_ on into block_. Returns the number of bytes available there.
  std::size_t make_available(std::size_t bytes);
  std::uint8_t byte_at(std::uint64_t i) const { return block_[std::size_t(i - block_begin_)]; }

  const std::filesystem::path& file_;
  SourceBytes bytes_;
  PlyFormat format_;
  std::uint64_t at_;
  std::size_t line_;
  std::vector<std::uint8_t> buffer_;
  std::span<const std::uint8_t> block_;
  std::uint64_t block_begin_ = 0;
};

}  // namespace gigabake
