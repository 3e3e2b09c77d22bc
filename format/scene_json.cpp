#include "format/scene_json.h"

#include <cmath>

#include "format/error.h"
#include "format/georeference.h"
#include "format/transform.h"

namespace gigabake {
namespace {

constexpr double radians = 0.017453292519943295;

struct Entry {
  std::filesystem::path path;
  std::string where;
  std::optional<Geodetic> position;
  std::array<double, 3> position_m{};
  double heading_deg = 0, scale = 1;
};

Entry read_entry(const std::filesystem::path& file, const Json& json, std::size_t i) {
  Entry e;
  e.where = "sources[" + std::to_string(i) + "]";
  const auto path = get_text(file, json, e.where, "path");
  if (!path) throw InputError(file, e.where + ".path", "is missing");
  e.path = resolve_uri(file.parent_path().empty() ? "." : file.parent_path(), file, e.where + ".path", *path);
  const Json& place = get_object(file, json, e.where, "place");
  if (const auto p = get_numbers(file, place, e.where + ".place", "position_m", 3))
    e.position_m = {(*p)[0], (*p)[1], (*p)[2]};
  if (const auto p = get_numbers(file, place, e.where + ".place", "lon_lat_height", 3)) {
    if (std::fabs((*p)[0]) > 360 || std::fabs((*p)[1]) > 90)
      throw InputError(file, e.where + ".place.lon_lat_height",
                       "expected degrees of longitude and latitude, and metres");
    e.position = Geodetic{(*p)[1], (*p)[0], (*p)[2]};
    if (place.contains("position_m"))
      throw InputError(file, e.where + ".place", "has both position_m and lon_lat_height");
  }
  e.heading_deg = get_number(file, json, e.where, "heading_deg").value_or(0);
  e.scale = get_number(file, json, e.where, "scale").value_or(1);
  if (!(e.scale > 0)) throw InputError(file, e.where + ".scale", "expected a positive number");
  return e;
}

Affine<Scene, Scene> heading_and_scale(const Entry& e) {
  const double c = std::cos(e.heading_deg * radians) * e.scale, s = std::sin(e.heading_deg * radians) * e.scale;
  Affine<Scene, Scene> r;
  r.m = {{{c, s, 0, 0}, {-s, c, 0, 0}, {0, 0, e.scale, 0}}};
  return r;
}

/// From the entry's own z-up frame to the scene.
Affine<Scene, Scene> placement(const Entry& e, const std::optional<Geodetic>& origin) {
  if (!e.position || !origin)
    return translation<Scene, Scene>(e.position_m[0], e.position_m[1], e.position_m[2]) * heading_and_scale(e);
  return scene_from_ecef(*origin) * ecef_from_enu(*e.position) * heading_and_scale(e);
}

}  // namespace

SceneSources open_scene_json(const std::filesystem::path& file, const Json& json, const SourceOptions& options) {
  if (get_index(file, json, "", "gigabake") != 1)
    throw InputError(file, "gigabake", "expected 1, the version of this format");
  std::vector<Entry> entries;
  const Json& list = get_array(file, json, "", "sources");
  for (std::size_t i = 0; i < list.size(); ++i) entries.push_back(read_entry(file, list[i], i));
  if (entries.empty()) throw InputError(file, "sources", "expected at least one source");
  SceneSources out;
  out.root = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  for (const Entry& e : entries) {
    if (e.position.has_value() != entries[0].position.has_value())
      throw InputError(file, e.where + ".place", "local and lon/lat placements cannot share a scene");
    if (e.position && !out.origin && !options.local) out.origin = options.origin ? options.origin : e.position;
  }
  if (options.local && entries[0].position)
    throw InputError(file, "sources", "lon/lat placements need a georeference; leave out --local");
  SourceOptions local = options;
  local.local = true;
  local.origin.reset();
  for (const Entry& e : entries) {
    const Affine<Scene, Scene> place = placement(e, out.origin);
    SceneSources part = open_sources(e.path, local);
    for (TileRef& tile : part.tiles) {
      tile.scene_from_tile = place * tile.scene_from_tile;
      tile.name = name_in(out.root, tile.path);
      out.tiles.push_back(std::move(tile));
    }
    out.skipped.insert(out.skipped.end(), part.skipped.begin(), part.skipped.end());
  }
  return out;
}

}  // namespace gigabake
