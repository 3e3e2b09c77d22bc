/// Shortening of names, paths and values that enter a message. They come from files and command lines and may have any
/// length; a message's own words, its cause and its remedy, are never cut.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gigabake {

inline constexpr std::size_t max_path_bytes = 100;
/// No message is longer. Its own words and a few quotes stay far below; only a file's text that entered without a
/// quote could reach it.
inline constexpr std::size_t max_line_bytes = 1000;

/// Returns whole UTF-8 characters from the beginning of `text`, at most `max_bytes`.
std::string_view head_of(std::string_view text, std::size_t max_bytes);

/// Returns `text` with "…" in place of its middle where it is longer than `max_bytes`.
std::string short_text(std::string_view text, std::size_t max_bytes);

/// Like short_text(), but keeps more of the end: a path ends with the name of its file.
std::string short_path(std::string_view path, std::size_t max_bytes = max_path_bytes);

/// Returns `text` with each word that is longer than any of our own shortened: a path, a number of a thousand digits.
std::string with_short_words(std::string_view text);

}  // namespace gigabake
