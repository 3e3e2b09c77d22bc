#include "core/base/quote.h"

#include <algorithm>

namespace gigabake {
namespace {

constexpr std::string_view ellipsis = "…";

bool is_inside_character(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
}

std::string_view tail_of(std::string_view text, std::size_t max_bytes) {
  std::size_t begin = text.size() - std::min(text.size(), max_bytes);
  while (is_inside_character(text, begin)) ++begin;
  return text.substr(begin);
}

/// Removes the middle of a text longer than `max_bytes`. The fraction 1/part of the kept bytes is at the beginning.
std::string without_middle(std::string_view text, std::size_t max_bytes, std::size_t part) {
  if (text.size() <= max_bytes) return std::string(text);
  const std::size_t kept = max_bytes - std::min(max_bytes, ellipsis.size()), head = kept / part;
  return std::string(head_of(text, head)).append(ellipsis).append(tail_of(text, kept - head));
}

}  // namespace

std::string_view head_of(std::string_view text, std::size_t max_bytes) {
  std::size_t end = std::min(text.size(), max_bytes);
  while (end > 0 && is_inside_character(text, end)) --end;
  return text.substr(0, end);
}

std::string short_text(std::string_view text, std::size_t max_bytes) { return without_middle(text, max_bytes, 2); }

std::string short_path(std::string_view path, std::size_t max_bytes) { return without_middle(path, max_bytes, 4); }

std::string with_short_words(std::string_view text) {
  constexpr std::string_view ends_of_words = " '\"\n\t";
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(ends_of_words, at), text.size());
    const std::string_view word = text.substr(at, end - at);
    out += word.find('/') == word.npos ? short_text(word, max_path_bytes) : short_path(word, max_path_bytes);
    if (end < text.size()) out += text[end];
    at = end + 1;
  }
  return out;
}

}  // namespace gigabake
