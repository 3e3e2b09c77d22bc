#include "core/base/valid_text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace gigabake {
namespace {

constexpr std::string_view replacement = "\xef\xbf\xbd";

/// A character and its number of bytes; 0 bytes if the first byte begins no valid sequence.
struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;
};

/// Decodes the first character.
/// Source  RFC 3629: shortest forms only, no surrogates, nothing above U+10FFFF.
Character decode(std::string_view text) {
  const auto byte = [&text](std::size_t i) { return std::uint32_t(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < bytes) return {};
  std::uint32_t code = first & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3f);
  }
  constexpr std::uint32_t min_code[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < min_code[bytes] || (code >= 0xd800 && code < 0xe000) || code > 0x10ffff) return {};
  return {code, bytes};
}

bool is_xml(std::uint32_t code) {
  return code >= 0x20 ? code != 0xfffe && code != 0xffff : code == '\t' || code == '\n' || code == '\r';
}

template <class IsAllowed>
std::string with_replacements(std::string_view text, const IsAllowed& is_allowed) {
  std::string out;
  while (!text.empty()) {
    const Character c = decode(text);
    const std::size_t bytes = std::max<std::size_t>(c.bytes, 1);
    out += c.bytes != 0 && is_allowed(c.code) ? text.substr(0, bytes) : replacement;
    text.remove_prefix(bytes);
  }
  return out;
}

}  // namespace

std::string valid_utf8(std::string_view text) {
  return with_replacements(text, [](std::uint32_t) { return true; });
}

std::string xml_text(std::string_view text) { return with_replacements(text, is_xml); }

}  // namespace gigabake
