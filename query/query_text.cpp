#include "query/query_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/base/error.h"
#include "core/base/valid_text.h"
#include "core/math/octahedral.h"
#include "query/query_npy.h"
#include "query/surface_height.h"

namespace gigabake {
namespace {

/// The numbers of decimals. Degrees have more decimals than metres, because a degree is about 10^5 metres.
constexpr int extra_degree_decimals = 5, max_decimals = 9, decimals_of_normals = 3;

void add_integer(std::int64_t v, std::string& text) {
  char digits[24];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, v).ptr);
}

/// Appends v, rounded to `decimals` decimals (at most 14).
void add_fixed(double v, int decimals, std::string& text) {
  static constexpr double powers[] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14};
  const double scaled = std::fabs(v) * powers[decimals];
  char digits[400];
  if (!(scaled < 9e15)) {
    text.append(digits, std::to_chars(digits, digits + sizeof digits, v, std::chars_format::fixed, decimals).ptr);
    return;
  }
  const auto whole = std::uint64_t(scaled + 0.5);
  if (v < 0 && whole != 0) text += '-';
  const auto length = std::size_t(std::to_chars(digits, digits + sizeof digits, whole).ptr - digits);
  const auto fraction = std::size_t(decimals);
  if (length <= fraction) {
    text += decimals > 0 ? "0." : "0";
    text.append(fraction - length, '0');
    text.append(digits, length);
    return;
  }
  text.append(digits, length - fraction);
  if (decimals > 0) text += '.';
  text.append(digits + (length - fraction), fraction);
}

void add_quoted_csv(const std::string& field, std::string& text) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) {
    text += field;
    return;
  }
  text += '"';
  for (const char c : field) text.append(c == '"' ? 2 : 1, c);
  text += '"';
}

void add_json_string(std::string_view value, std::string& text) {
  static constexpr char hex[] = "0123456789abcdef";
  text += '"';
  for (const char c : valid_utf8(value)) {  // identifiers in a file may be any bytes
    if (c == '"' || c == '\\') text += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      (((text += "\\u00") += hex[c >> 4]) += hex[c & 15]);
    else
      text += c;
  }
  text += '"';
}

struct Normal {
  double n[3];
  explicit Normal(const std::int8_t oct[2]) { decode_octahedral(oct, n); }
};

}  // namespace

int decimals_for(double step) { return std::clamp(-int(std::floor(std::log10(step) + 1e-9)), 0, max_decimals); }

QueryText::QueryText(QueryFormat format, QueryKind kind, const QueryFrames& frames, double voxel_size_m,
                     QueryColumns columns, std::optional<std::uint64_t> count)
    : format_(format),
      kind_(kind),
      frames_(frames),
      decimals_(decimals_for(voxel_size_m / 1000)),
      columns_(columns),
      count_(count.value_or(0)) {
  if (format == QueryFormat::npy && !count)
    throw UsageError("format", "npy states the number of answers first; expected a .npy table, a grid or one query");
  if (format == QueryFormat::geojson && !frames.is_on_earth())
    throw UsageError("format",
                     "GeoJSON needs longitudes and latitudes, and the scene has no position on the "
                     "earth; expected csv or json");
}

std::string_view QueryText::outcome(QueryOutcome outcome) const {
  if (kind_ == QueryKind::sight && outcome == QueryOutcome::hit) return "blocked";
  if (kind_ == QueryKind::sight && outcome == QueryOutcome::nothing) return "visible";
  return name_of(outcome);
}

std::string QueryText::begin() const {
  if (format_ == QueryFormat::geojson) return "{\"type\":\"FeatureCollection\",\"features\":[";
  if (format_ == QueryFormat::json) return "[";
  if (format_ == QueryFormat::npy) return npy_header(kind_, frames_.frame(), count_, columns_.classes);
  return std::string(columns_.ids ? "id," : "") + (columns_.stations ? "station_m," : "") + "outcome,distance_m," +
         (frames_.frame() == QueryFrame::lonlat ? "lon,lat,height" : "x,y,z") +
         (kind_ == QueryKind::height ? ",height_error_m" : "") + ",nx,ny,nz,red,green,blue,coverage," +
         (columns_.classes ? "class," : "") + "lod,cell\n";
}

std::string QueryText::end() const {
  if (format_ == QueryFormat::geojson) return "\n]}\n";
  return format_ == QueryFormat::json ? "\n]\n" : "";
}

void QueryText::add(const QueryAnswer& answer, bool first, std::string& text) const {
  if (format_ == QueryFormat::npy) return add_npy(answer, kind_, frames_, columns_.classes, text);
  if (format_ != QueryFormat::csv) text += first ? "\n" : ",\n";
  if (format_ == QueryFormat::csv) add_csv(answer, text);
  if (format_ == QueryFormat::json) add_json(answer, text);
  if (format_ == QueryFormat::geojson) add_geojson(answer, text);
}

double QueryText::height_error_m(const QueryHit& hit) const {
  return frames_.metres(height_error_edges * kernels::power_of_two(hit.lod));
}

int QueryText::height_decimals(const QueryHit& hit) const {
  const bool is_height = kind_ == QueryKind::height && hit.outcome == QueryOutcome::hit;
  if (!is_height) return decimals_;
  // A plane is stored to 1/30 voxel. Without one, the height of the surface in the voxel is less certain.
  return decimals_for(frames_.metres(kernels::power_of_two(hit.lod)) / (hit.plane != 0 ? 100 : 10));
}

void QueryText::add_lonlat(const QueryPoint& p, int height_decimals, std::string& text) const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (a > 0) text += ',';
    add_fixed(p[a], a < 2 ? decimals_ + extra_degree_decimals : height_decimals, text);
  }
}

void QueryText::add_point(const QueryPoint& p, int height_decimals, std::string& text) const {
  if (frames_.is_in_degrees()) return add_lonlat(p, height_decimals, text);
  for (std::size_t a = 0; a < 3; ++a) {
    if (a > 0) text += ',';
    add_fixed(p[a], a < 2 ? decimals_ : height_decimals, text);
  }
}

void QueryText::add_csv(const QueryAnswer& answer, std::string& text) const {
  const QueryHit& hit = answer.hit;
  if (columns_.ids) {
    add_quoted_csv(answer.input.id, text);
    text += ',';
  }
  if (columns_.stations) {
    add_fixed(answer.input.station_m, decimals_, text);
    text += ',';
  }
  text += outcome(hit.outcome);
  text += ',';
  const bool is_hit = hit.outcome == QueryOutcome::hit;
  if (is_hit || hit.outcome == QueryOutcome::missing)
    add_fixed(frames_.metres(hit.distance), height_decimals(hit), text);
  text += ',';
  if (is_hit) {
    add_point(frames_.point_in_query_frame(frames_.scene_point(answer.ray, hit.distance)), height_decimals(hit), text);
    if (kind_ == QueryKind::height) {
      text += ',';
      add_fixed(height_error_m(hit), decimals_, text);
    }
    for (const double n : Normal(hit.normal).n) {
      text += ',';
      add_fixed(n, decimals_of_normals, text);
    }
    for (int c = 0; c < 4; ++c) {
      text += ',';
      add_integer(hit.rgba >> 8 * c & 255, text);
    }
    text += ',';
    if (columns_.classes) {
      add_integer(hit.voxel_class, text);
      text += ',';
    }
    add_integer(hit.lod, text);
    text += ',';
  } else if (kind_ == QueryKind::height) {
    QueryPoint place = answer.input.from;
    place[2] = 0;
    add_point(place, decimals_, text);
    text.erase(text.rfind(',') + 1);  // no height was found
    text += columns_.classes ? ",,,,,,,,,,," : ",,,,,,,,,,";
  } else {
    text += columns_.classes ? ",,,,,,,,,,,," : ",,,,,,,,,,,";
  }
  text += answer.shard;
  text += '\n';
}

/// Appends the members that each answer has, up to the distance.
void QueryText::add_outcome(const QueryAnswer& answer, std::string& text) const {
  const QueryHit& hit = answer.hit;
  if (columns_.ids) {
    text += "\"id\":";
    add_json_string(answer.input.id, text);
    text += ',';
  }
  if (columns_.stations) {
    text += "\"station_m\":";
    add_fixed(answer.input.station_m, decimals_, text);
    text += ',';
  }
  text += "\"outcome\":";
  add_json_string(outcome(hit.outcome), text);
  if (hit.outcome != QueryOutcome::hit && hit.outcome != QueryOutcome::missing) return;
  text += ",\"distance_m\":";
  add_fixed(frames_.metres(hit.distance), height_decimals(hit), text);
}

/// Appends the last members of an answer.
void QueryText::add_place(const QueryAnswer& answer, std::string& text) const {
  if (answer.hit.outcome == QueryOutcome::hit) {
    if (columns_.classes) {
      text += ",\"class\":";
      add_integer(answer.hit.voxel_class, text);
    }
    text += ",\"lod\":";
    add_integer(answer.hit.lod, text);
  }
  if (answer.shard.empty()) return;
  text += ",\"cell\":";
  add_json_string(answer.shard, text);
}

/// Appends the members of an answer in JSON, with the position in the query's frame.
void QueryText::add_members(const QueryAnswer& answer, std::string& text) const {
  const QueryHit& hit = answer.hit;
  add_outcome(answer, text);
  if (hit.outcome == QueryOutcome::hit) {
    text += ",\"position\":[";
    add_point(frames_.point_in_query_frame(frames_.scene_point(answer.ray, hit.distance)), height_decimals(hit), text);
    text += ']';
    if (kind_ == QueryKind::height) {
      text += ",\"height_error_m\":";
      add_fixed(height_error_m(hit), decimals_, text);
    }
    text += ",\"normal\":[";
    for (const double n : Normal(hit.normal).n) {
      add_fixed(n, decimals_of_normals, text);
      text += ',';
    }
    text.back() = ']';
    text += ",\"rgba\":[";
    for (int c = 0; c < 4; ++c) {
      add_integer(hit.rgba >> 8 * c & 255, text);
      text += ',';
    }
    text.back() = ']';
  }
  add_place(answer, text);
}

/// Appends the properties of a feature. Each is a single number or a text, because programs that read GeoJSON into
/// tables (OGR) take lists for text.
void QueryText::add_properties(const QueryAnswer& answer, std::string& text) const {
  const QueryHit& hit = answer.hit;
  add_outcome(answer, text);
  const auto number = [&](const char* name, double value, int decimals) {
    text += ",\"" + std::string(name) + "\":";
    add_fixed(value, decimals, text);
  };
  if (hit.outcome == QueryOutcome::hit) {
    const Point<Scene> p = frames_.scene_point(answer.ray, hit.distance);
    number("height_m", frames_.lonlat_point(p)[2], height_decimals(hit));
    if (kind_ == QueryKind::height) number("height_error_m", height_error_m(hit), decimals_);
    number("scene_x_m", p.x, decimals_);
    number("scene_y_m", p.y, decimals_);
    number("scene_z_m", p.z, height_decimals(hit));
    const Normal normal(hit.normal);
    for (std::size_t a = 0; a < 3; ++a) number(std::array{"nx", "ny", "nz"}[a], normal.n[a], decimals_of_normals);
    for (std::size_t c = 0; c < 4; ++c)
      number(std::array{"red", "green", "blue", "coverage"}[c], hit.rgba >> 8 * c & 255, 0);
  }
  add_place(answer, text);
}

void QueryText::add_json(const QueryAnswer& answer, std::string& text) const {
  text += '{';
  if (kind_ == QueryKind::height) {
    text += "\"at\":[";
    add_point({answer.input.from[0], answer.input.from[1], 0}, decimals_, text);
    text.erase(text.rfind(','));
    text += "],";
  }
  add_members(answer, text);
  text += '}';
}

QueryPoint QueryText::input_lonlat(const QueryPoint& asked) const { return frames_.degrees_of(asked); }

/// Appends a feature. A hit gives a point; a line of sight gives a line to the obstacle or to the end point. A height
/// query without a hit gives a point without height. A ray without a hit gives no geometry.
void QueryText::add_geojson(const QueryAnswer& answer, std::string& text) const {
  const bool is_hit = answer.hit.outcome == QueryOutcome::hit;
  const auto met = [&] { return frames_.lonlat_point(frames_.scene_point(answer.ray, answer.hit.distance)); };
  text += "{\"type\":\"Feature\",\"geometry\":";
  if (kind_ == QueryKind::sight) {
    text += "{\"type\":\"LineString\",\"coordinates\":[[";
    add_lonlat(input_lonlat(answer.input.from), decimals_, text);
    text += "],[";
    add_lonlat(is_hit ? met() : input_lonlat(answer.input.to), decimals_, text);
    text += "]]}";
  } else if (is_hit || kind_ == QueryKind::height) {
    text += "{\"type\":\"Point\",\"coordinates\":[";
    add_lonlat(is_hit ? met() : input_lonlat({answer.input.from[0], answer.input.from[1], 0}),
               height_decimals(answer.hit), text);
    if (!is_hit) text.erase(text.rfind(','));
    text += "]}";
  } else {
    text += "null";
  }
  text += ",\"properties\":{";
  add_properties(answer, text);
  text += "}}";
}

}  // namespace gigabake
