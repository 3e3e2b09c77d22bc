#include "app/options/area_options.h"

#include <fmt/format.h>

#include "app/options/text_values.h"
#include "core/base/error.h"
#include "core/base/usage_errors.h"
#include "format/area/geojson.h"
#include "format/source/raster/crs_map.h"

namespace gigabake::app {
namespace {

constexpr const char* bounds_form = "W,S,E,N or W,S,E,N,LOW,HIGH";

/// Checks that the corners of bounds have a place on the earth.
void expect_covered(const Area& area, const std::vector<double>& n, const std::string& crs) {
  for (const double x : {n[0], n[2]})
    for (const double y : {n[1], n[3]})
      if (!area.crs_map->has_place({x, y, n.size() < 6 ? 0.0 : n[4]}))
        throw UsageError(
            fmt::format("--bounds: {:g}, {:g} has no place on the earth in --crs {}; it lies outside the "
                        "system, or PROJ misses a grid for it",
                        x, y, crs));
}

Area area_of(const AreaOptions& options) {
  Area area;
  const bool is_scene = options.crs == "scene";
  if (!options.crs.empty() && !is_scene) {
    area.crs_map = open_crs_map(options.crs);
    area.crs = options.crs;
  }
  if (!options.clip.empty()) area.polygons = read_geojson_polygons(options.clip);
  if (options.bounds.empty()) return area;
  const std::vector<double> n = numbers("--bounds", bounds_form, options.bounds, {4, 6});
  const AreaFrame placed = area.crs_map ? AreaFrame::crs : AreaFrame::degrees;
  area.bounds = bounds_of_numbers("--bounds", n, is_scene ? AreaFrame::scene : placed);
  if (area.crs_map) expect_covered(area, n, options.crs);
  return area;
}

}  // namespace

void AreaOptions::add_to(CLI::App& command) {
  command.add_option("--bounds", bounds,
                     "W,S,E,N[,LOW,HIGH]: use only this part, in degrees and in metres above the WGS84 ellipsoid "
                     "(docs/maps.md)");
  command.add_option("--clip", clip, "AREA.geojson: use only the part inside its polygons");
  command.add_option("--crs", crs,
                     "coordinate system of --bounds, such as EPSG:25832; scene: metres of the scene's frame");
}

std::shared_ptr<const Area> AreaOptions::area() const {
  if (!crs.empty() && bounds.empty()) throw UsageError("--crs: is the coordinate system of --bounds, which is missing");
  if (bounds.empty() && clip.empty()) return nullptr;
  return with_usage_errors([&] { return std::make_shared<const Area>(area_of(*this)); });
}

std::string AreaOptions::text() const {
  std::string out;
  for (const auto& [name, value] :
       {std::pair("--bounds", &bounds), std::pair("--clip", &clip), std::pair("--crs", &crs)})
    if (!value->empty()) out += fmt::format("{}{} {}", out.empty() ? "" : " ", name, *value);
  return out;
}

}  // namespace gigabake::app
