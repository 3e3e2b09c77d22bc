/// MD5, the hash of file names in the index of a .3tz archive. It is not used for security.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace gigabake {

/// Returns the MD5 hash of the text.
/// Source  RFC 1321.
std::array<std::uint8_t, 16> md5_of(std::string_view text);

}  // namespace gigabake
