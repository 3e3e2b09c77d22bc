/// Numbers as people type them in options.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lattice/frames.h"

namespace gigabake::app {

/// Errors (all)  UsageError: the option, what was expected, what was typed.
double number(const char* option, std::string_view text);
/// Three finite numbers with commas between; `form` says what they are.
std::array<double, 3> triple(const char* option, const char* form, const std::string& text);
/// Numbers with commas between, as many as one of `counts`.
std::vector<double> numbers(const char* option, const char* form, const std::string& text,
                            std::initializer_list<std::size_t> counts);
/// Whole numbers between single separators; nothing where there is anything else.
std::optional<std::vector<int>> integers(const std::string& text, char separator);
/// X,Y,Z in scene metres; nothing where it is empty.
std::optional<Point<Scene>> point_option(const std::string& text, const char* option);
/// --size: WIDTHxHEIGHT.
std::pair<int, int> size_option(const std::string& text);
Geodetic geodetic(const char* option, const std::string& text);

}  // namespace gigabake::app
