/// Parsers for numbers in options.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/math/frames.h"
#include "core/math/vec3.h"

namespace gigabake::app {

/// Parses one finite number.
/// Errors  UsageError with the option, the expected form and the text. All functions of this file except integers()
///         throw it.
double number(const char* option, std::string_view text);
/// Parses three finite numbers separated by commas. `form` describes them in the error message.
Vec3d triple(const char* option, const char* form, const std::string& text);
/// Parses numbers separated by commas. Their number must be in `counts`.
std::vector<double> numbers(const char* option, const char* form, const std::string& text,
                            std::initializer_list<std::size_t> counts);
/// Parses integers between single separators; returns nullopt for any other text.
std::optional<std::vector<int>> integers(const std::string& text, char separator);
/// Parses X,Y,Z in scene metres; returns nullopt for an empty text.
std::optional<Point<Scene>> point_option(const std::string& text, const char* option);
/// Parses --size: WIDTHxHEIGHT.
std::pair<int, int> size_option(const std::string& text);
Geodetic geodetic(const char* option, const std::string& text);

}  // namespace gigabake::app
