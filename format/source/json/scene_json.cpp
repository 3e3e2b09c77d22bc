#include "format/source/json/scene_json.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/math/transform.h"
#include "format/edit/edit_json.h"
#include "format/edit/scene_edits.h"
#include "format/edit/source_edit_json.h"
#include "format/edit/source_edits_in_scene.h"
#include "format/source/classes/source_classes.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/origin_check.h"
#include "format/source/raster/dem.h"
#include "format/source/raster/dem_source.h"
#include "format/source/shape_mesh.h"
#include "format/source/source_files.h"
#include "format/source/tiles/tileset_document.h"
#include "format/system/json/json_members.h"

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
  std::optional<Geodetic> position;    ///< on the earth; nullopt: position_m applies
  std::array<double, 3> position_m{};  ///< in the scene, in metres
  double heading_deg = 0, scale = 1;
  std::shared_ptr<const SourceEdits> edits = nullptr;
  std::shared_ptr<const SourceVoxelSize> voxel_size = nullptr;
  std::shared_ptr<const NamedVoxelSizes> named_sizes = nullptr;
  std::shared_ptr<const SourceClasses> classes = nullptr;
};

/// Returns the edits of an entry, then the edits in the options that concern it; null if there are none. `name` is the
/// entry's path.
std::shared_ptr<const SourceEdits> edits_in(const JsonMembers& entry, const std::string& name,
                                            const SourceOptions& options) {
  SourceEdits edits = source_edits_of(entry);
  if (options.source_edits)
    for (const NamedSourceEdit& edit : *options.source_edits)
      if (edit.source.empty() || edit.source == name) edits.list.push_back(edit.edit);
  return edits.list.empty() ? nullptr : std::make_shared<const SourceEdits>(std::move(edits));
}

/// Returns the voxel size of an entry; null if it states none.
std::shared_ptr<const SourceVoxelSize> voxel_size_of(const JsonMembers& entry) {
  const auto metres = entry.find<double>("voxel_size_m");
  if (!metres) return nullptr;
  if (!(*metres >= 1e-6 && *metres <= 1e6)) entry.fail("voxel_size_m", "expected 1e-6 to 1e6 metres");
  return std::make_shared<const SourceVoxelSize>(SourceVoxelSize{entry.file(), entry.path_of("voxel_size_m"), *metres});
}

void read_place(const JsonMembers& place, Entry& e) {
  place.only({"position_m", "lon_lat_height"});
  const auto metres = place.numbers<3>("position_m");
  const auto degrees = place.numbers<3>("lon_lat_height");
  if (metres.has_value() == degrees.has_value())
    throw InputError(place.file(), place.path(), "expected either position_m or lon_lat_height");
  if (metres) e.position_m = *metres;
  if (!degrees) return;
  if (std::fabs((*degrees)[0]) > 360 || std::fabs((*degrees)[1]) > 90)
    place.fail("lon_lat_height", "expected degrees of longitude (±360) and latitude (±90), and metres, in this order");
  e.position = Geodetic{(*degrees)[1], (*degrees)[0], (*degrees)[2]};
}

/// Opens a source. A source without "place" keeps the geographic position in its file. If its file has no position, its
/// origin is the scene's origin.
Entry read_entry(const JsonMembers& json, SourceOptions options, const Progress& progress) {
  const std::filesystem::path& file = json.file();
  Entry e;
  e.where = json.path();
  options.origin.reset();
  options.area.reset();  // the area and the edits refer to the frame of the whole scene
  options.edits.reset();
  const auto path = json.get<std::string>("path");
  json.only({"path", "place", "heading_deg", "scale", "voxel_size_m", "voxel_size_of_material", "voxel_size_of_node",
             "class", "class_of_material", "class_from_ids", "edits"});
  e.edits = edits_in(json, path, options);
  options.source_edits.reset();
  e.voxel_size = voxel_size_of(json);
  e.named_sizes = named_voxel_sizes_of(json);
  e.classes = source_classes_of(json);
  const bool is_placed = json.contains("place");
  if (is_placed) read_place(json.members("place"), e);
  e.heading_deg = json.find<double>("heading_deg").value_or(0);
  e.scale = json.find<double>("scale").value_or(1);
  if (!(e.scale > 0)) json.fail("scale", "expected a positive number");
  options.local |= is_placed;
  const std::filesystem::path target = resolve_name(root_of(file), file, json.path_of("path"), path);
  if (is_scene(target)) json.fail("path", in_quotes(path) + " is a scene; scenes do not nest");
  e.source = open_sources(target, options, progress);
  if (!is_placed) e.position = e.source.origin;
  return e;
}

/// Returns the value of a surface, which its entries must share; `comparable` maps a value to one that is compared.
/// `where` names the entries of rasters. `difference` begins the error's cause, before the first entry's name.
template <class T, class Comparable>
std::shared_ptr<const T> value_of_surface(const std::filesystem::path& file, const DemRaster& raster,
                                          const std::map<std::filesystem::path, std::string>& where,
                                          const std::map<std::string, std::shared_ptr<const T>>& values,
                                          const char* member, const char* difference, const Comparable& comparable) {
  const std::string& first = where.at(raster.parts[0].options.dem);
  for (const DemPart& part : raster.parts)
    if (const std::string& entry = where.at(part.options.dem);
        comparable(values.at(entry)) != comparable(values.at(first)))
      throw UsageError(
          InputError(file, entry + member, difference + first + ", which is a part of the same surface").what());
  return values.at(first);
}

/// Returns the text of the member `path` or `dem` of an entry; empty if it is not one text.
std::string name_of_entry(const Json& entry) {
  for (const char* key : {"path", "dem"})
    if (entry.is_object() && entry.contains(key) && entry[key].is_string()) return entry[key].get<std::string>();
  return {};
}

/// Checks that each named edit in the options names an entry.
void expect_named_entries(const Json& list, const SourceOptions& options) {
  if (!options.source_edits) return;
  for (const NamedSourceEdit& edit : *options.source_edits) {
    const auto is_named = [&](const Json& entry) { return name_of_entry(entry) == edit.source; };
    if (!edit.source.empty() && std::none_of(list.begin(), list.end(), is_named))
      refuse(edit, "no source of the scene has the path " + in_quotes(edit.source));
  }
}

/// Opens the rasters of all entries together, because one surface may consist of several entries. Returns one entry per
/// surface.
std::vector<Entry> raster_entries(const JsonMembers& scene, const Json& list, const SourceOptions& options,
                                  const Progress& progress) {
  const std::filesystem::path& file = scene.file();
  std::vector<DemOptions> rasters;
  std::map<std::filesystem::path, std::string> where;
  std::map<std::string, std::shared_ptr<const SourceEdits>> edits;
  std::map<std::string, std::shared_ptr<const SourceVoxelSize>> sizes;
  std::map<std::string, std::shared_ptr<const SourceClasses>> classes;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_object() || !list[i].contains("dem")) continue;
    const JsonMembers entry = scene.element("sources", list, i);
    entry.only({"dem", "ortho", "crs", "ortho_crs", "nodata", "height_scale", "geoid_offset_m", "tile_cells",
                "voxel_size_m", "class", "edits"});
    edits[entry.path()] = edits_in(entry, name_of_entry(list[i]), options);
    sizes[entry.path()] = voxel_size_of(entry);
    classes[entry.path()] = source_classes_of(entry);
    for (DemOptions& o : dem_options(entry)) {
      where.emplace(o.dem, entry.path());
      rasters.push_back(std::move(o));
    }
  }
  std::vector<Entry> out;
  if (rasters.empty()) return out;
  SourceOptions own = options;
  own.origin.reset();
  own.area.reset();
  own.edits.reset();
  own.source_edits.reset();
  for (SceneSources& source : dem_sources(root_of(file), rasters, own, progress)) {
    Entry e;
    e.where = where.at(source.tiles.front().dem->raster->parts[0].options.dem);
    e.position = source.origin;
    const DemRaster& raster = *source.tiles.front().dem->raster;
    e.edits = value_of_surface(file, raster, where, edits, ".edits", "differ from the edits of ",
                               [](const auto& own_edits) { return own_edits ? to_json(*own_edits) : std::string(); });
    e.voxel_size = value_of_surface(file, raster, where, sizes, ".voxel_size_m", "differs from that of ",
                                    [](const auto& size) { return size ? size->metres : 0; });
    e.classes = value_of_surface(
        file, raster, where, classes, ".class", "differs from that of ",
        [](const auto& own_classes) { return own_classes ? std::optional(own_classes->of_source) : std::nullopt; });
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
  if (e.edits) placed_edits(*e.edits, out.origin);  // throws early if the scene has no place for them
  const Affine<Scene, Scene> place = placement(e, out.origin);
  // The names of the last file are cached: many tiles of a raster or a composite share a file, and name_in() needs
  // system calls.
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
    tile.edits = e.edits;
    tile.voxel_size = e.voxel_size;
    tile.named_sizes = e.named_sizes;
    tile.classes = e.classes;
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
  const JsonMembers scene(file, json);
  if (scene.find<std::uint64_t>("gigabake") != 1) scene.fail("gigabake", "expected 1, the version of this format");
  scene.only({"gigabake", "sources", "edits"});
  std::vector<Entry> entries;
  const Json& list = scene.array("sources");
  expect_named_entries(list, options);
  std::vector<Entry> surfaces = raster_entries(scene, list, options, progress);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonMembers entry = scene.element("sources", list, i);
    if (!entry.contains("dem")) {
      entries.push_back(read_entry(entry, options, progress));
      continue;
    }
    for (Entry& surface : surfaces)
      if (surface.where == entry.path()) entries.push_back(std::move(surface));
  }
  if (entries.empty()) throw InputError(file, "sources", "expected at least one source");
  SceneSources out;
  out.is_scene_json = true;
  out.root = root_of(file);
  for (const Entry& e : entries)
    if (e.position.has_value() != entries[0].position.has_value())
      throw InputError(file, e.where, "local and lon/lat placements cannot share a scene");
  if (options.local && entries[0].position)
    throw InputError(file, "sources", "lon/lat placements need a georeference; leave out `local`");
  if (!options.local) out.origin = options.origin ? options.origin : entries[0].position;
  const auto mesh_at = [&](const JsonMembers& shape) {
    const auto path = shape.get<std::string>("path");
    const auto up = shape.find<UpAxis>("up");
    try {
      return read_shape_mesh(resolve_name(root_of(file), file, shape.path_of("path"), path), up);
    } catch (const InputError& e) {
      shape.fail("path", e.what());
    }
  };
  if (EditList edits = edits_of(scene, mesh_at); !edits.empty())
    out.edits = std::make_shared<const EditList>(std::move(edits));
  add_place_warnings(entries, out);
  progress.step("placing the sources", entries.size(), "source");
  for (Entry& e : entries) {
    add_entry(std::move(e), out);
    progress.advance();
  }
  return out;
}

}  // namespace gigabake
