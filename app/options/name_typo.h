/// Detection of mistyped names.
#pragma once

#include <string_view>

namespace gigabake::app {

/// Returns true if two different names may be typos of each other. They differ in case or separators only, in one
/// character of one word, or by two swapped neighbours. Names that differ in numbers or last letters form a series and
/// are not typos: run_1 and run_2, run_a and run_b, outA and outB. Compares bytes; only ASCII letters have a case.
bool looks_like_typo(std::string_view name, std::string_view other);

}  // namespace gigabake::app
