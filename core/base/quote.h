/// Functions that shorten names, paths and values in messages. These texts come from files and command lines and may
/// have any length. The message's own words, cause and remedy are never cut.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gigabake {

inline constexpr std::size_t max_path_bytes = 100;
/// The max length of a message in bytes. The program's own words with a few quotes are far shorter. Only a text of a
/// file that a message contains without quotes can reach this limit.
inline constexpr std::size_t max_line_bytes = 1000;

/// Returns the first `max_bytes` bytes of `text`, or fewer if the last UTF-8 character would be incomplete.
std::string_view head_of(std::string_view text, std::size_t max_bytes);

/// Returns `text`; if it is longer than `max_bytes`, its middle becomes "…".
std::string short_text(std::string_view text, std::size_t max_bytes);

/// Like short_text(), but keeps more of the end, because a path ends with the file's name.
std::string short_path(std::string_view path, std::size_t max_bytes = max_path_bytes);

/// Returns `text` with short forms of all words longer than max_path_bytes, such as a path or a number of a thousand
/// digits.
std::string with_short_words(std::string_view text);

}  // namespace gigabake
