/// MD5, by which the index of a .3tz archive names its files; for nothing that must resist somebody.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace gigabake {

/// Source  RFC 1321.
std::array<std::uint8_t, 16> md5_of(std::string_view text);

}  // namespace gigabake
