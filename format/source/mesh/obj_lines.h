/// The lines of OBJ, MTL and other text, in memory or still in its file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/source_bytes.h"

namespace gigabake {

/// A line of OBJ or MTL: its first word, and the rest without spaces around it.
struct ObjLine {
  std::size_t number = 0;
  std::string_view word, rest;
};

/// "line 12", made a text only if it is needed.
struct LineName {
  std::size_t number = 0;
  operator std::string() const { return "line " + std::to_string(number); }
};

/// Visits the lines that are not empty and no comments; a backslash at the end joins the next one. Lines end by a line
/// feed, a carriage return, or both; a byte order mark of UTF-8 at the beginning is no part of them.
/// Errors  InputError: bytes of zero (UTF-16, binary), before any line is visited.
void for_each_obj_line(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                       const std::function<void(const ObjLine&)>& visit);

/// As above, of text of any length. Cost  a block of the file and a line are in memory.
/// Errors  InputError: bytes of zero, before any line of their block is visited; a line of more than 64 MiB.
void for_each_obj_line(const std::filesystem::path& file, const SourceBytes& text,
                       const std::function<void(const ObjLine&)>& visit);

/// Of a file's beginning the lines that are there to their end.
std::span<const std::uint8_t> whole_lines(std::span<const std::uint8_t> head);

/// The word at the beginning of `rest`, which loses it and the spaces behind it.
std::string_view take_word(std::string_view& rest);

/// Returns `text` without a comment at its end: a word that begins with '#'.
std::string_view without_comment(std::string_view text);

/// Returns a name without quotation marks around it, and with '/' in place of '\\'.
std::string plain_name(std::string_view name);

/// Leading numbers of `text`; stops at the first word that is none. Exact  the nearest double.
std::vector<double> obj_numbers(std::string_view text, std::size_t most);

}  // namespace gigabake
