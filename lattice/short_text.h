/// Text of a file as a message may quote it.
#pragma once

#include <string>
#include <string_view>

namespace gigabake {

/// At most 40 bytes, whole letters of UTF-8, then "…"; blanks in place of control characters.
std::string short_text(std::string_view text);

}  // namespace gigabake
