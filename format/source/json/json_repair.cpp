#include "format/source/json/json_repair.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "core/base/valid_text.h"

namespace gigabake {
namespace {

constexpr std::size_t escape_bytes = 6;  // \uXXXX

/// Returns the code of an escape \uXXXX at the beginning of a text; 0 if there is none.
std::uint32_t escaped_code(std::string_view text) {
  if (text.size() < escape_bytes || !text.starts_with("\\u")) return 0;
  std::uint32_t code = 0;
  const auto [end, error] = std::from_chars(text.data() + 2, text.data() + escape_bytes, code, 16);
  return error == std::errc() && end == text.data() + escape_bytes ? code : 0;
}

bool is_high_surrogate(std::uint32_t code) { return code >= 0xd800 && code < 0xdc00; }
bool is_low_surrogate(std::uint32_t code) { return code >= 0xdc00 && code < 0xe000; }

/// Replaces unpaired surrogate escapes. Returns whether the text had an unpaired surrogate escape.
bool replace_lone_surrogates(std::string& text) {
  bool has_replaced = false;
  for (std::size_t at = text.find('\\'); at < text.size(); at = text.find('\\', at)) {
    const std::string_view rest = std::string_view(text).substr(at);
    const std::uint32_t code = escaped_code(rest);
    if (code == 0) {
      at += 2;
    } else if (is_high_surrogate(code) && is_low_surrogate(escaped_code(rest.substr(escape_bytes)))) {
      at += 2 * escape_bytes;
    } else {
      if (is_high_surrogate(code) || is_low_surrogate(code)) text.replace(at + 2, 4, "fffd"), has_replaced = true;
      at += escape_bytes;
    }
  }
  return has_replaced;
}

}  // namespace

std::optional<std::string> repaired_json(std::span<const std::uint8_t> text) {
  constexpr std::string_view surrogate_digits = "dD";
  const std::string_view view(reinterpret_cast<const char*>(text.data()), text.size());
  const bool has_bytes = std::any_of(view.begin(), view.end(), [](char c) { return (c & 0x80) != 0; });
  bool has_surrogates = false;
  for (std::size_t at = view.find("\\u"); at != view.npos && !has_surrogates; at = view.find("\\u", at + 2))
    has_surrogates = at + 2 < view.size() && surrogate_digits.find(view[at + 2]) != surrogate_digits.npos;
  if (!has_bytes && !has_surrogates) return std::nullopt;
  std::string out = has_bytes ? valid_utf8(view) : std::string(view);
  const bool has_replaced = replace_lone_surrogates(out);
  if (!has_replaced && out == view) return std::nullopt;
  return out;
}

}  // namespace gigabake
