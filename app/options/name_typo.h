/// Names that differ as a mistyped name differs from the name that was meant.
#pragma once

#include <string_view>

namespace gigabake::app {

/// Returns true if two different names differ in case or separators only, or in one character of one word, or in two
/// neighbours that changed places. Numbers and last letters tell names of a series apart: run_1 and run_2, run_a and
/// run_b, outA and outB are no typos of each other. Compares bytes; only ASCII letters have a case.
bool looks_like_typo(std::string_view name, std::string_view other);

}  // namespace gigabake::app
