/// Numbers of things, as messages to people say them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace gigabake {

/// "1 cell", "2 cells", "0 cells".
/// plural   What follows any other number than 1; empty: the noun and an s.
std::string counted(std::uint64_t count, std::string_view noun, std::string_view plural = {});

}  // namespace gigabake
