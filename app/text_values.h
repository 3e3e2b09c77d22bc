/// Numbers as people type them in options.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "format/frames.h"

namespace gigabake::app {

/// Errors (all)  UsageError: the option, what was expected, what was typed.
double number(const char* option, std::string_view text);
/// Three finite numbers with commas between; `form` says what they are.
std::array<double, 3> triple(const char* option, const char* form, const std::string& text);
Geodetic geodetic(const char* option, const std::string& text);

}  // namespace gigabake::app
