#include "app/messages/similar_lines.h"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

#include "cluster/bake/tile_loss.h"
#include "core/base/error.h"
#include "core/base/quote.h"

namespace gigabake::app {
namespace {

constexpr std::size_t max_lines_per_group = 3, max_lines = 50;
constexpr std::size_t max_name_bytes = 160;  // a path and the key of an entry in it

bool is_power_of_ten(std::size_t n) {
  while (n % 10 == 0 && n > 9) n /= 10;
  return n == 1;
}

/// Shortens only the name, because a name from a file may have any length.
std::string name_of(const SceneLoss& loss) { return as_line(short_path(loss.name, max_name_bytes)); }

std::string line_of(const SceneLoss& loss) {
  const std::string rest = reason_without_tile(loss);
  return name_of(loss) + ": " + as_line(rest.empty() ? loss.reason : rest);
}

}  // namespace

std::string kind_of(std::string_view line) {
  std::string kind;
  for (const char c : line) {
    const bool is_digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (!is_digit)
      kind += c;
    else if (kind.empty() || kind.back() != '#')
      kind += '#';
  }
  std::string plain;  // a cell's column may be negative: c_-#_#
  for (std::size_t i = 0; i < kind.size(); ++i)
    if (kind[i] != '-' || i + 1 == kind.size() || kind[i + 1] != '#') plain += kind[i];
  return plain;
}

std::string SimilarLineFilter::pass(const std::string& line) {
  const std::size_t seen = ++seen_[kind_of(line)];
  if (seen <= max_lines_per_group) return line;
  return is_power_of_ten(seen) ? fmt::format("{} (the {}th such line)", line, seen) : "";
}

std::vector<std::string> lines_of(const std::vector<SceneLoss>& losses) {
  std::unordered_map<std::string, std::size_t> all, seen;
  for (const SceneLoss& loss : losses) ++all[kind_of(line_of(loss))];
  std::vector<std::string> lines;
  std::size_t shown_lines = 0;
  for (const SceneLoss& loss : losses) {
    if (lines.size() + 1 >= max_lines) break;
    const std::string kind = kind_of(line_of(loss));
    const std::size_t number = ++seen[kind], others = all[kind] - std::min(all[kind], max_lines_per_group);
    if (number > max_lines_per_group + 1) continue;
    const bool is_sum = number > max_lines_per_group && others > 1;
    lines.push_back(is_sum ? fmt::format("and {} more like {}", others, name_of(loss)) : line_of(loss));
    shown_lines += is_sum ? others : 1;
  }
  if (shown_lines < losses.size())
    lines.push_back(fmt::format("and {} more; --json lists them all", losses.size() - shown_lines));
  return lines;
}

}  // namespace gigabake::app
