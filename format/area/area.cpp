#include "format/area/area.h"

#include <cmath>
#include <fmt/format.h>

#include "core/base/error.h"

namespace gigabake {
namespace {

void expect_ascending(const char* option, const char* low_name, double low, const char* high_name, double high,
                      const char* remedy = "") {
  if (low < high) return;
  throw UsageError(fmt::format("{}: {} {:g} is {} {} {:g}; expected W,S,E,N[,LOW,HIGH]{}", option, low_name, low,
                               low == high ? "equal to" : "greater than", high_name, high, remedy));
}

void expect_degrees(const char* option, const std::vector<double>& n) {
  if (std::fabs(n[1]) > max_latitude_degrees || std::fabs(n[3]) > max_latitude_degrees ||
      std::fabs(n[0]) > full_turn_degrees || std::fabs(n[2]) > full_turn_degrees || n[2] - n[0] > full_turn_degrees)
    throw UsageError(fmt::format(
        "{}: expected degrees W,S,E,N: latitudes within ±90, longitudes within ±360; metres need `crs`", option));
}

void put(ByteWriter& w, const FixedPoint& p) { w.put(p.x), w.put(p.y); }

FixedPoint get_point(ByteReader& r) {
  FixedPoint p;
  r.get(p.x), r.get(p.y);
  if (std::max(std::fabs(double(p.x)), std::fabs(double(p.y))) > max_area_coordinate * fixed_per_unit)
    throw InputError("area", "position", "expected a coordinate within ±1e9");
  return p;
}

AreaBounds get_bounds(ByteReader& r) {
  AreaBounds b;
  r.get(b.frame);
  b.low = get_point(r), b.high = get_point(r);
  r.get(b.height_low_m), r.get(b.height_high_m);
  return b;
}

AreaPolygon get_polygon(ByteReader& r) {
  std::uint64_t rings = 0, positions = 0;
  std::vector<Ring> out;
  for (r.get(rings); rings > 0; --rings) {
    out.emplace_back();
    for (r.get(positions); positions > 0; --positions) out.back().push_back(get_point(r));
    if (out.back().size() < 3) throw InputError("area", "ring", "expected at least three positions");
  }
  if (out.empty()) throw InputError("area", "polygon", "expected at least one ring");
  return AreaPolygon(std::move(out));
}

}  // namespace

AreaBounds bounds_of_numbers(const char* option, const std::vector<double>& n, AreaFrame frame) {
  const bool is_degrees = frame == AreaFrame::degrees;
  for (std::size_t i = 0; i < 4; ++i)
    if (std::fabs(n.at(i)) > max_area_coordinate)
      throw UsageError(fmt::format("{}: expected coordinates within ±1e9, got {:g}", option, n[i]));
  if (is_degrees) expect_degrees(option, n);
  expect_ascending(option, "west", n[0], "east", n[2], is_degrees ? "; across the antimeridian, add 360 to E" : "");
  expect_ascending(option, "south", n[1], "north", n[3]);
  AreaBounds out;
  out.frame = frame;
  out.low = {to_fixed(n[0]), to_fixed(n[1])};
  out.high = {to_fixed(n[2]), to_fixed(n[3])};
  if (is_degrees && n[3] == max_latitude_degrees) ++out.high.y;  // the pole is inside
  if (out.low.x == out.high.x || out.low.y == out.high.y)
    throw UsageError(fmt::format("{}: is narrower than {:.0e}", option, 1 / fixed_per_unit));
  if (n.size() < 6) return out;
  expect_ascending(option, "LOW", n[4], "HIGH", n[5]);
  out.height_low_m = n[4], out.height_high_m = n[5];
  return out;
}

bool is_on_earth(const Area& area) {
  return !area.polygons.empty() || (area.bounds && area.bounds->frame != AreaFrame::scene);
}

void put(ByteWriter& w, const Area& area) {
  w.put(std::uint8_t(area.bounds.has_value()));
  if (const auto& b = area.bounds) {
    w.put(b->frame);
    put(w, b->low), put(w, b->high);
    w.put(b->height_low_m), w.put(b->height_high_m);
  }
  w.put(area.crs);
  w.put(std::uint64_t(area.polygons.size()));
  for (const AreaPolygon& polygon : area.polygons) {
    w.put(std::uint64_t(polygon.rings().size()));
    for (const Ring& ring : polygon.rings()) {
      w.put(std::uint64_t(ring.size()));
      for (const FixedPoint& p : ring) put(w, p);
    }
  }
}

Area get_area(ByteReader& r) {
  Area area;
  bool has_bounds = false;
  r.get(has_bounds);
  if (has_bounds) area.bounds = get_bounds(r);
  r.get(area.crs);
  if ((has_bounds && area.bounds->frame == AreaFrame::crs) == area.crs.empty())
    throw InputError("area", "crs", "expected a coordinate system for bounds in its coordinates only");
  std::uint64_t polygons = 0;
  for (r.get(polygons); polygons > 0; --polygons) area.polygons.push_back(get_polygon(r));
  return area;
}

}  // namespace gigabake
