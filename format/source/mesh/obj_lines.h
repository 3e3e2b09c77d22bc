/// Lines of OBJ, MTL and other text, read from memory or from a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/content/source_bytes.h"

namespace gigabake {

/// A line of OBJ or MTL: its first word, and the rest without leading and trailing spaces.
struct ObjLine {
  std::size_t number = 0;
  std::string_view word, rest;
};

/// The text "line 12", created only if it is needed.
struct LineName {
  std::size_t number = 0;
  operator std::string() const { return "line " + std::to_string(number); }
};

/// Visits all lines except empty lines and comments. A backslash at the end of a line joins the next line. A line ends
/// with a line feed, a carriage return, or both. A UTF-8 byte order mark at the beginning is skipped.
/// Errors  InputError: the text has zero bytes (UTF-16, binary); thrown before any line is visited.
void for_each_obj_line(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                       const std::function<void(const ObjLine&)>& visit);

/// Visits lines like the overload for text in memory, for text of any length.
/// Cost    One block of the file and one line in memory.
/// Errors  InputError: the text has zero bytes, thrown before any line of their block is visited; a line of more than
///         64 MiB.
void for_each_obj_line(const std::filesystem::path& file, const SourceBytes& text,
                       const std::function<void(const ObjLine&)>& visit);

/// Returns `head`, the beginning of a file, without an incomplete line at its end.
std::span<const std::uint8_t> whole_lines(std::span<const std::uint8_t> head);

/// Removes the first word and the spaces after it from `rest`. Returns the word.
std::string_view take_word(std::string_view& rest);

/// Returns `text` without a trailing comment, which begins with '#' at the start of a word.
std::string_view without_comment(std::string_view text);

/// Returns a name without enclosing quotation marks, and with '/' in place of '\\'.
std::string plain_name(std::string_view name);

/// Returns up to `max_count` leading numbers of `text`; stops at the first word that is not a number.
/// Exact   Each number is rounded to the nearest double.
std::vector<double> obj_numbers(std::string_view text, std::size_t max_count);

}  // namespace gigabake
