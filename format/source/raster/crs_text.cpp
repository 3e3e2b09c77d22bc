#include "format/source/raster/crs_text.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <string_view>

namespace gigabake {
namespace {

constexpr std::size_t max_text_bytes = std::size_t(1) << 16;

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  return out;
}

/// Returns whether a text is AUTHORITY:CODE. Both consist of letters, digits and '_'; a code may also have '.', '+'
/// and '-'.
bool is_code(std::string_view text) {
  const auto colon = text.find(':');
  if (colon == 0 || colon == text.npos || colon + 1 == text.size()) return false;
  const auto is_word = [](std::string_view word, std::string_view more) {
    return std::all_of(word.begin(), word.end(),
                       [&](unsigned char c) { return std::isalnum(c) != 0 || more.find(char(c)) != more.npos; });
  };
  return is_word(text.substr(0, colon), "_") && is_word(text.substr(colon + 1), "_.+-");
}

/// Returns whether a PROJ parameter is known and names no file. The "+" is optional.
/// Source  PROJ 9, "Projections" and "Parameters of cartographic projections".
bool is_plain_parameter(std::string_view word) {
  static const std::set<std::string_view> known{
      "a",      "alpha",      "axis",   "azi",    "b",       "datum",    "ellps",   "es",      "f",       "gamma",
      "h",      "k",          "k_0",    "lat_0",  "lat_1",   "lat_2",    "lat_3",   "lat_b",   "lat_t",   "lat_ts",
      "lon_0",  "lon_1",      "lon_2",  "lon_3",  "lonc",    "lon_wrap", "lsat",    "m",       "M",       "n",
      "no_cut", "no_defs",    "no_off", "no_rot", "no_uoff", "over",     "path",    "pm",      "proj",    "q",
      "R",      "R_A",        "R_C",    "R_V",    "R_a",     "R_g",      "R_h",     "R_lat_a", "R_lat_g", "rf",
      "south",  "south_pole", "sweep",  "tilt",   "title",   "to_meter", "towgs84", "type",    "units",   "vto_meter",
      "vunits", "W",          "wktext", "x_0",    "y_0",     "zone"};
  if (word.starts_with('+')) word.remove_prefix(1);
  const std::string_view name = word.substr(0, word.find('='));
  if (name == "nadgrids") return word == "nadgrids=@null";  // Web Mercator: no grid
  if (name == "proj" && (word == "proj=pipeline" || word == "proj=defmodel" || word == "proj=tinshift")) return false;
  return word.empty() || known.contains(name);
}

bool are_plain_parameters(std::string_view text) {
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;)
    if (!is_plain_parameter(word)) return false;
  return true;
}

/// Returns whether a list of grids has only names without folders, which PROJ looks up in its own folders.
bool are_plain_grids(std::string_view list) {
  return std::all_of(list.begin(), list.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.' || c == ',' || c == '@';
  });
}

/// Returns whether all PROJ texts in quoted strings of a WKT have only plain parameters, and lists of geoid grids have
/// only plain names.
bool holds_plain_quotes(std::string_view wkt) {
  std::string_view previous;
  for (auto at = wkt.find('"'); at != wkt.npos;) {
    const auto end = wkt.find('"', at + 1);
    if (end == wkt.npos) return true;  // GDAL rejects such a text
    const std::string_view quoted = wkt.substr(at + 1, end - at - 1);
    const auto proj = quoted.find('+');
    if (quoted.find("proj=") != quoted.npos || quoted.find("init=") != quoted.npos)
      if (proj == quoted.npos || !are_plain_parameters(quoted.substr(proj))) return false;
    if (upper(previous) == "PROJ4_GRIDS" && !are_plain_grids(quoted)) return false;
    previous = quoted;
    at = wkt.find('"', end + 1);
  }
  return true;
}

bool is_plain_structure(std::string_view text) {
  return upper(text).find("PARAMETERFILE") == std::string::npos && holds_plain_quotes(text);
}

/// Returns whether a PROJJSON has no parameter whose value is a text: such a value is a file. An escaped character
/// could hide the name of a member.
bool has_plain_values(std::string_view json) {
  constexpr std::string_view key = "\"value\"";
  if (json.find('\\') != json.npos) return false;
  for (auto at = json.find(key); at != json.npos; at = json.find(key, at + 1)) {
    const auto value = json.find_first_not_of(" \t\r\n:", at + key.size());
    if (value == json.npos || json[value] == '"') return false;
  }
  return true;
}

/// Returns whether a text begins with a keyword and a bracket.
bool is_wkt(std::string_view text) {
  const auto bracket = text.find_first_of("[(");
  return bracket != 0 && bracket != text.npos &&
         std::all_of(text.begin(), text.begin() + std::ptrdiff_t(bracket),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == ' '; });
}

}  // namespace

bool is_plain_crs(const std::string& text) {
  if (text.size() > max_text_bytes || text.find('\0') != text.npos) return false;
  const auto begin = text.find_first_not_of(" \t\r\n");
  if (begin == text.npos) return false;
  const std::string_view trimmed = std::string_view(text).substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
  if (is_code(trimmed)) return true;
  if (trimmed.starts_with("+") || trimmed.starts_with("proj=")) return are_plain_parameters(trimmed);
  if (trimmed.starts_with("{")) return has_plain_values(trimmed) && is_plain_structure(trimmed);
  if (is_wkt(trimmed)) return is_plain_structure(trimmed);
  return false;
}

}  // namespace gigabake
