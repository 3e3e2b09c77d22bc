#include "format/area/geojson.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "format/system/json/json_members.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t max_file_bytes = std::uint64_t(1) << 28;
constexpr double max_longitude = 360, half_turn = 180;
constexpr std::size_t min_ring_positions = 4;

struct Position {
  double longitude_deg = 0, latitude_deg = 0;
  friend bool operator==(const Position&, const Position&) = default;
};

/// A reader of geometries. Feature, FeatureCollection and GeometryCollection may contain them.
class GeometryReader {
 public:
  explicit GeometryReader(const std::filesystem::path& file) : file_(file) {}
  virtual ~GeometryReader() = default;

 protected:
  /// Reads a geometry. `where` is the path of the object in the file.
  virtual void read_geometry(const std::string& type, const Json& object, const std::string& where) = 0;

  void read_root() {
    const std::vector<std::uint8_t> bytes = read_whole_file(file_, max_file_bytes);
    const Json root = parse_json_object(file_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    expect_degrees(root);
    read_object(root, "");
  }

  [[noreturn]] void fail(const std::string& key, const std::string& message) const {
    throw InputError(file_, key, message);
  }

  static std::string joined(const std::string& where, const std::string& key) {
    return where.empty() ? key : where + "." + key;
  }

  /// Returns the value of a member that must be an array.
  const Json& array_of(const Json& object, const char* key, const std::string& where) const {
    if (!object.contains(key) || !object[key].is_array()) fail(joined(where, key), "expected an array");
    return object[key];
  }

  /// Returns the positions of an array, at least `minimum`.
  std::vector<Position> positions_of(const Json& values, const std::string& key, std::size_t minimum) const {
    if (!values.is_array()) fail(key, "expected an array of positions");
    std::vector<Position> line;
    for (std::size_t i = 0; i < values.size(); ++i)
      line.push_back(position_of(values[i], fmt::format("{}[{}]", key, i)));
    if (line.size() < minimum) fail(key, fmt::format("expected at least {} positions, got {}", minimum, line.size()));
    return line;
  }

 private:
  /// Refuses a coordinate system of the older GeoJSON that is not WGS84 longitude and latitude.
  void expect_degrees(const Json& root) const {
    if (!root.contains("crs") || root["crs"].is_null()) return;
    const std::string text = root["crs"].dump();
    for (const std::string_view known : {"CRS84", "EPSG:4326", "EPSG::4326"})
      if (text.find(known) != std::string::npos) return;
    fail("crs", "expected longitude and latitude on WGS84; convert it with ogr2ogr -t_srs EPSG:4326 OUT.geojson " +
                    file_.filename().string());
  }

  void read_all(const Json& object, const char* key, const std::string& where) {
    const Json& list = array_of(object, key, where);
    for (std::size_t i = 0; i < list.size(); ++i) read_object(list[i], fmt::format("{}[{}]", joined(where, key), i));
  }

  void read_object(const Json& object, const std::string& where) {
    const JsonMembers members(file_, object, where);
    const auto type = members.get<std::string>("type", "the type of a GeoJSON object");
    if (type == "FeatureCollection") return read_all(object, "features", where);
    if (type == "GeometryCollection") return read_all(object, "geometries", where);
    if (type != "Feature") return read_geometry(type, object, where);
    if (!object.contains("geometry")) fail(joined(where, "geometry"), "is missing");
    read_object(object["geometry"], joined(where, "geometry"));
  }

  Position position_of(const Json& value, const std::string& key) const {
    if (!value.is_array() || value.size() < 2 || !value[0].is_number() || !value[1].is_number())
      fail(key, "expected a position: longitude and latitude in degrees");
    const Position p{value[0].get<double>(), value[1].get<double>()};
    if (!(std::fabs(p.longitude_deg) <= max_longitude && std::fabs(p.latitude_deg) <= max_latitude_degrees))
      fail(key, fmt::format("expected longitude and latitude in degrees, got {:g}, {:g}; ogr2ogr -t_srs EPSG:4326 "
                            "converts metres",
                            p.longitude_deg, p.latitude_deg));
    return p;
  }

  const std::filesystem::path& file_;
};

class PolygonReader final : public GeometryReader {
 public:
  using GeometryReader::GeometryReader;

  std::vector<AreaPolygon> read() {
    read_root();
    if (polygons_.empty()) fail("", "holds no polygon");
    return std::move(polygons_);
  }

 private:
  void read_geometry(const std::string& type, const Json& object, const std::string& where) override {
    const std::string key = joined(where, "coordinates");
    if (type == "Polygon") return read_polygon(array_of(object, "coordinates", where), key);
    if (type != "MultiPolygon") fail(joined(where, "type"), "expected Polygon or MultiPolygon, got " + in_quotes(type));
    const Json& list = array_of(object, "coordinates", where);
    for (std::size_t i = 0; i < list.size(); ++i) read_polygon(list[i], fmt::format("{}[{}]", key, i));
  }

  void read_polygon(const Json& rings, const std::string& key) {
    if (!rings.is_array() || rings.empty()) fail(key, "expected the rings of a polygon");
    std::vector<Ring> out;
    for (std::size_t r = 0; r < rings.size(); ++r) {
      out.push_back(ring_of(rings[r], fmt::format("{}[{}]", key, r)));
      if (r != 0) move_next_to(out.front(), out.back());
    }
    if (const auto fault = fault_of(out)) fail(key, *fault);
    polygons_.emplace_back(std::move(out));
  }

  /// Returns a ring with continuous longitudes.
  Ring ring_of(const Json& positions, const std::string& key) const {
    const std::vector<Position> line = positions_of(positions, key, min_ring_positions);
    if (line.front() != line.back()) fail(key, "is not closed: its last position differs from its first");
    double turn = 0;
    Ring ring;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const double step = i == 0 ? 0 : line[i].longitude_deg - line[i - 1].longitude_deg;
      if (std::fabs(step) > half_turn && std::fabs(step) < full_turn_degrees)
        turn -= std::copysign(full_turn_degrees, step);
      const FixedPoint p{to_fixed(line[i].longitude_deg + turn), to_fixed(line[i].latitude_deg)};
      if (ring.empty() || ring.back() != p) ring.push_back(p);
    }
    if (turn != 0) fail(key, "encloses a pole; cut it at the antimeridian");
    ring.pop_back();
    if (ring.size() < min_ring_positions - 1) fail(key, "has no area");
    return ring;
  }

  /// Moves a hole by whole turns, so that its longitudes are in the range of the outer ring.
  static void move_next_to(const Ring& outer, Ring& hole) {
    const auto west_of = [](const Ring& ring) {
      return std::min_element(ring.begin(), ring.end(), [](auto& a, auto& b) { return a.x < b.x; })->x;
    };
    const std::int64_t turn = to_fixed(full_turn_degrees), west = west_of(outer);
    while (west_of(hole) < west)
      for (FixedPoint& p : hole) p.x += turn;
    while (west_of(hole) >= west + turn)
      for (FixedPoint& p : hole) p.x -= turn;
  }

  std::vector<AreaPolygon> polygons_;
};

class LineReader final : public GeometryReader {
 public:
  using GeometryReader::GeometryReader;

  std::vector<Geodetic> read() {
    read_root();
    if (line_.empty()) fail("", "holds no line; expected one LineString");
    return std::move(line_);
  }

 private:
  void read_geometry(const std::string& type, const Json& object, const std::string& where) override {
    if (type != "LineString") fail(joined(where, "type"), "expected LineString, got " + in_quotes(type));
    const std::string key = joined(where, "coordinates");
    if (!line_.empty()) fail(key, "is a second line; expected one LineString in the file");
    for (const Position& p : positions_of(array_of(object, "coordinates", where), key, 2)) {
      const Geodetic vertex{p.latitude_deg, p.longitude_deg, 0};
      if (line_.empty() || line_.back() != vertex) line_.push_back(vertex);
    }
    if (line_.size() < 2) fail(key, "has no length; expected at least two different positions");
  }

  std::vector<Geodetic> line_;
};

}  // namespace

std::vector<AreaPolygon> read_geojson_polygons(const std::filesystem::path& file) { return PolygonReader(file).read(); }

std::vector<Geodetic> read_geojson_line(const std::filesystem::path& file) { return LineReader(file).read(); }

}  // namespace gigabake
