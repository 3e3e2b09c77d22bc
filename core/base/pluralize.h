/// Counts with their nouns for messages, for example "2 cells".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace gigabake {

/// Returns a count and its noun: "1 cell", "2 cells", "0 cells". `plural` is the noun for all counts but 1; if it is
/// empty, an s is appended to `noun`.
std::string pluralize(std::uint64_t count, std::string_view noun, std::string_view plural = {});

}  // namespace gigabake
