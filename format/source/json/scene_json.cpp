#include "format/source/json/scene_json.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/math/transform.h"
#include "format/source/origin_check.h"
#include "format/source/raster/dem.h"
#include "format/source/raster/dem_source.h"
#include "format/source/source_files.h"
#include "format/source/tiles/tileset_document.h"

namespace gigabake {
namespace {

constexpr double radians = std::numbers::pi / 180;

bool is_scene(const std::filesystem::path& path) {
  std::error_code error;
  if (lower_extension(path) != ".json" || !std::filesystem::is_regular_file(path, error)) return false;
  const Json json = parse_tileset(path, SourceFiles(path.parent_path()).read_content(path)).json;
  return json.is_object() && json.contains("gigabake");
}

std::filesystem::path root_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

/// One listed source in its own frame, and the position of that frame.
struct Entry {
  std::string where;
  SceneSources source;
  std::optional<Geodetic> position;    ///< on the earth, or
  std::array<double, 3> position_m{};  ///< in the scene
  double heading_deg = 0, scale = 1;
};

/// Refuses unknown keys: a misspelt key would silently place a source at the origin.
void expect_only(const std::filesystem::path& file, const Json& object, const std::string& where,
                 std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : object.items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw InputError(file, where, "has an unknown key " + in_quotes(key));
}

void read_place(const std::filesystem::path& file, const Json& place, const std::string& where, Entry& e) {
  expect_only(file, place, where, {"position_m", "lon_lat_height"});
  const auto metres = get_numbers(file, place, where, "position_m", 3);
  const auto degrees = get_numbers(file, place, where, "lon_lat_height", 3);
  if (metres.has_value() == degrees.has_value())
    throw InputError(file, where, "expected either position_m or lon_lat_height");
  if (metres) e.position_m = {(*metres)[0], (*metres)[1], (*metres)[2]};
  if (!degrees) return;
  if (std::fabs((*degrees)[0]) > 360 || std::fabs((*degrees)[1]) > 90)
    throw InputError(file, where + ".lon_lat_height",
                     "expected degrees of longitude (±360) and latitude (±90), and metres, in this order");
  e.position = Geodetic{(*degrees)[1], (*degrees)[0], (*degrees)[2]};
}

/// Opens a source. A source without "place" keeps the geographic position in its file; if there is none, its origin is
/// the scene's origin.
Entry read_entry(const std::filesystem::path& file, const Json& json, std::size_t i, SourceOptions options,
                 const Progress& progress) {
  Entry e;
  e.where = "sources[" + std::to_string(i) + "]";
  options.origin.reset();
  const auto path = get_text(file, json, e.where, "path");
  if (!path) throw InputError(file, e.where + ".path", "is missing");
  expect_only(file, json, e.where, {"path", "place", "heading_deg", "scale"});
  const bool is_placed = json.contains("place");
  if (is_placed) read_place(file, get_object(file, json, e.where, "place"), e.where + ".place", e);
  e.heading_deg = get_number(file, json, e.where, "heading_deg").value_or(0);
  e.scale = get_number(file, json, e.where, "scale").value_or(1);
  if (!(e.scale > 0)) throw InputError(file, e.where + ".scale", "expected a positive number");
  options.local |= is_placed;
  const std::filesystem::path target = resolve_name(root_of(file), file, e.where + ".path", *path);
  if (is_scene(target)) throw InputError(file, e.where + ".path", in_quotes(*path) + " is a scene; scenes do not nest");
  e.source = open_sources(target, options, progress);
  if (!is_placed) e.position = e.source.origin;
  return e;
}

/// Returns the rasters of all entries: their surfaces may consist of several entries.
std::vector<Entry> raster_entries(const std::filesystem::path& file, const Json& list, const SourceOptions& options,
                                  const Progress& progress) {
  std::vector<DemOptions> rasters;
  std::map<std::filesystem::path, std::string> where;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_object() || !list[i].contains("dem")) continue;
    const std::string entry = "sources[" + std::to_string(i) + "]";
    expect_only(file, list[i], entry,
                {"dem", "ortho", "crs", "ortho_crs", "nodata", "height_scale", "geoid_offset_m", "tile_cells"});
    for (DemOptions& o : dem_options(file, list[i], entry)) {
      where.emplace(o.dem, entry);
      rasters.push_back(std::move(o));
    }
  }
  std::vector<Entry> out;
  if (rasters.empty()) return out;
  SourceOptions own = options;
  own.origin.reset();
  for (SceneSources& source : dem_sources(root_of(file), rasters, own, progress)) {
    Entry e;
    e.where = where.at(source.tiles.front().dem->raster->parts[0].options.dem);
    e.position = source.origin;
    e.source = std::move(source);
    out.push_back(std::move(e));
  }
  if (options.local && out.size() > 1)
    throw InputError(file, out[1].where + ".dem",
                     "its pixels are not on the grid of the first raster, so `local` cannot place them together");
  return out;
}

Affine<Scene, Scene> heading_and_scale(const Entry& e) {
  const double c = std::cos(e.heading_deg * radians) * e.scale, s = std::sin(e.heading_deg * radians) * e.scale;
  Affine<Scene, Scene> r;
  r.m = {{{c, s, 0, 0}, {-s, c, 0, 0}, {0, 0, e.scale, 0}}};
  return r;
}

/// Returns the transform from the entry's own z-up frame to the scene.
Affine<Scene, Scene> placement(const Entry& e, const std::optional<Geodetic>& origin) {
  if (!e.position || !origin)
    return translation<Scene, Scene>(e.position_m[0], e.position_m[1], e.position_m[2]) * heading_and_scale(e);
  return scene_from_ecef(*origin) * ecef_from_enu(*e.position) * heading_and_scale(e);
}

void add_entry(Entry e, SceneSources& out) {
  const Affine<Scene, Scene> place = placement(e, out.origin);
  // Cached names of the file: many tiles of a raster or a composite share it, and finding them takes system calls.
  std::filesystem::path file;
  std::string own, name;
  for (TileRef& tile : e.source.tiles) {
    tile.scene_from_tile = place * tile.scene_from_tile;
    if (tile.path != file) {
      file = tile.path;
      own = name_in(e.source.root, file);
      name = name_in(out.root, file);
    }
    tile.name = name + tile.name.substr(std::min(own.size(), tile.name.size()));  // keeps the part, e.g. "[1]"
    out.tiles.push_back(std::move(tile));
  }
  for (const std::string& note : e.source.notes) out.notes.push_back(note);
  for (SkippedSource& lost : e.source.skipped) {
    lost.name = name_in(out.root, e.source.root / lost.name);
    out.skipped.push_back(std::move(lost));
  }
}

void add_place_warnings(const std::vector<Entry>& entries, SceneSources& out) {
  std::vector<NamedPlace> named;
  std::vector<Geodetic> places;
  for (const Entry& e : entries) {
    if (!e.position) continue;
    named.push_back({e.where, *e.position});
    places.push_back(*e.position);
  }
  if (out.origin)
    if (auto warning = far_origin_warning(*out.origin, places)) out.notes.push_back(std::move(*warning));
  if (auto warning = far_places_warning(named)) out.notes.push_back(std::move(*warning));
}

}  // namespace

SceneSources open_scene_json(const std::filesystem::path& file, const Json& json, const SourceOptions& options,
                             const Progress& progress) {
  if (get_index(file, json, "", "gigabake") != 1)
    throw InputError(file, "gigabake", "expected 1, the version of this format");
  expect_only(file, json, "", {"gigabake", "sources"});
  std::vector<Entry> entries;
  const Json& list = get_array(file, json, "", "sources");
  std::vector<Entry> surfaces = raster_entries(file, list, options, progress);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_object() || !list[i].contains("dem")) {
      entries.push_back(read_entry(file, list[i], i, options, progress));
      continue;
    }
    for (Entry& surface : surfaces)
      if (surface.where == "sources[" + std::to_string(i) + "]") entries.push_back(std::move(surface));
  }
  if (entries.empty()) throw InputError(file, "sources", "expected at least one source");
  SceneSources out;
  out.root = root_of(file);
  for (const Entry& e : entries)
    if (e.position.has_value() != entries[0].position.has_value())
      throw InputError(file, e.where, "local and lon/lat placements cannot share a scene");
  if (options.local && entries[0].position)
    throw InputError(file, "sources", "lon/lat placements need a georeference; leave out `local`");
  if (!options.local) out.origin = options.origin ? options.origin : entries[0].position;
  add_place_warnings(entries, out);
  progress.step("placing the sources", entries.size(), "source");
  for (Entry& e : entries) {
    add_entry(std::move(e), out);
    progress.advance();
  }
  return out;
}

}  // namespace gigabake
