/// Conversions of arbitrary bytes, such as file names, to the texts that formats accept.
#pragma once

#include <string>
#include <string_view>

namespace gigabake {

/// Returns `text` as valid UTF-8: each invalid byte becomes U+FFFD.
std::string valid_utf8(std::string_view text);

/// Returns valid_utf8(text) with U+FFFD in place of each character that XML 1.0 excludes. Excluded are control
/// characters except tab, line feed and carriage return, and U+FFFE and U+FFFF.
/// Source  https://www.w3.org/TR/xml/#charsets
std::string xml_text(std::string_view text);

}  // namespace gigabake
