#include "app/options/text_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

#include "core/base/error.h"

namespace gigabake::app {

double number(const char* option, std::string_view text) {
  double v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(v))
    throw UsageError(fmt::format("{}: expected a number, got '{}'", option, text));
  return v;
}

Vec3d triple(const char* option, const char* form, const std::string& text) {
  Vec3d v{};
  std::size_t at = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = i < 2 ? text.find(',', at) : text.size();
    if (comma == std::string::npos) throw UsageError(fmt::format("{}: expected {}, got '{}'", option, form, text));
    v[i] = number(option, std::string_view(text).substr(at, comma - at));
    at = comma + 1;
  }
  return v;
}

std::vector<double> numbers(const char* option, const char* form, const std::string& text,
                            std::initializer_list<std::size_t> counts) {
  std::vector<double> values;
  for (std::size_t at = 0;;) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    values.push_back(number(option, std::string_view(text).substr(at, comma - at)));
    if (comma == text.size()) break;
    at = comma + 1;
  }
  if (std::find(counts.begin(), counts.end(), values.size()) == counts.end())
    throw UsageError(fmt::format("{}: expected {}, got '{}'", option, form, text));
  return values;
}

std::optional<std::vector<int>> integers(const std::string& text, char separator) {
  std::vector<int> out;
  const char *at = text.data(), *end = at + text.size();
  for (;; ++at) {
    int value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || next == at) return std::nullopt;
    out.push_back(value);
    at = next;
    if (at == end) return out;
    if (*at != separator) return std::nullopt;
  }
}

std::optional<Point<Scene>> point_option(const std::string& text, const char* option) {
  if (text.empty()) return std::nullopt;
  const Vec3d v = triple(option, "X,Y,Z as three finite numbers", text);
  return Point<Scene>{v[0], v[1], v[2]};
}

std::pair<int, int> size_option(const std::string& text) {
  const auto size = integers(text, 'x');
  if (!size || size->size() != 2) throw UsageError(fmt::format("--size: expected WIDTHxHEIGHT, got '{}'", text));
  return {(*size)[0], (*size)[1]};
}

Geodetic geodetic(const char* option, const std::string& text) {
  const auto v = triple(option, "LAT,LON,HEIGHT in degrees and metres", text);
  if (std::fabs(v[0]) > 90 || std::fabs(v[1]) > 360)
    throw UsageError(std::string(option) +
                     ": latitude is within ±90°, longitude within ±360°; the order is LAT,LON,HEIGHT: "
                     "are the two swapped?");
  return {v[0], v[1], v[2]};
}

}  // namespace gigabake::app
