#include "format/source/source.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "core/math/georeference.h"
#include "core/math/transform.h"
#include "format/edit/scene_edits.h"
#include "format/edit/source_edits_in_scene.h"
#include "format/source/content/composite.h"
#include "format/source/earth_centred.h"
#include "format/source/folder_listing.h"
#include "format/source/json/scene_json.h"
#include "format/source/origin_check.h"
#include "format/source/raster/dem_source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"
#include "format/source/tiles/pnts.h"
#include "format/source/tiles/tileset.h"
#include "format/source/tiles/tileset_place.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

Path folder_of(const Path& file) { return file.has_parent_path() ? file.parent_path() : Path("."); }

/// Returns the transform from the source's own frame to the local scene: z up by default.
Affine<Scene, World> local_scene(const SourceOptions& options) {
  return z_up_from<Scene, World>(options.scene_up.value_or(UpAxis::z));
}

TileMembers tile_members(const SourceOptions& options) {
  return options.area ? TileMembers::all : TileMembers::without_volumes;
}

/// Returns a function that makes the filter for the area of interest; empty without an area. The tileset is placed by
/// its anchor, like the scene.
MakeVolumeFilter volume_filter(const SourceOptions& options) {
  if (!options.area) return {};
  return [&options](const std::optional<Point<Ecef>>& anchor) {
    if (!anchor || options.local)
      return VolumeFilter(options.area, options.local ? std::nullopt : options.origin, local_scene(options));
    const Geodetic origin = options.origin.value_or(geodetic_of(*anchor));
    Affine<Scene, World> scene_from_world;
    scene_from_world.m = scene_from_ecef(origin).m;
    return VolumeFilter(options.area, origin, scene_from_world);
  };
}

/// Returns the format by the file name extension; nullopt if no content format has the extension.
std::optional<ContentKind> kind_of(const Path& path) {
  static const std::map<std::string, ContentKind> kinds{{".glb", ContentKind::glb},   {".gltf", ContentKind::gltf},
                                                        {".b3dm", ContentKind::b3dm}, {".i3dm", ContentKind::i3dm},
                                                        {".obj", ContentKind::obj},   {".ply", ContentKind::ply},
                                                        {".stl", ContentKind::stl}};
  const auto at = kinds.find(lower_extension(path));
  return at == kinds.end() ? std::nullopt : std::optional(at->second);
}

/// Returns whether the file is a mesh or a point cloud. Point clouds are not baked, but are reported to the user.
bool is_mesh(const Path& path) {
  const std::string extension = lower_extension(path);
  return kind_of(path) || extension == ".cmpt" || extension == ".pnts";
}

void add_mesh_file(const Path& path, const SourceOptions& options, SceneSources& out) {
  const SourceFiles files(out.root);
  TileRef tile;
  tile.path = path;
  tile.name = name_in(out.root, path);
  tile.gltf_up = options.scene_up.value_or(UpAxis::y);
  tile.bytes = files.size_of(path);
  if (const auto kind = kind_of(path)) {
    tile.kind = *kind;
    out.tiles.push_back(tile);
    return;
  }
  if (lower_extension(path) == ".pnts") return out.skipped.push_back(skipped_points(tile, files, tile.name));
  for (const CompositePart& part : parts_of_composite(path, files.read_content(path))) {
    TileRef inner = tile;
    inner.name += part.name;
    inner.range = part.range;
    inner.kind = part.magic == ContentMagic::i3dm ? ContentKind::i3dm : ContentKind::b3dm;
    if (part.magic == ContentMagic::points)
      out.skipped.push_back(skipped_points(inner, files, inner.name));
    else
      out.tiles.push_back(std::move(inner));
  }
}

/// Removes the files whose stated bounds lie outside the area. Files that state no bounds remain.
void drop_outside(const SourceOptions& options, SceneSources& sources) {
  const VolumeFilter filter(options.area, sources.origin, {});
  const auto is_outside = [&](const TileRef& tile) {
    if (tile.kind != ContentKind::glb && tile.kind != ContentKind::gltf && tile.kind != ContentKind::b3dm) return false;
    try {
      const WorldBox box = stated_bounds(tile, SourceFiles(sources.root));
      Affine<World, World> place;
      place.m = tile.scene_from_tile.m;
      return !box.is_empty && !filter.may_overlap(volume_of(box), place);
    } catch (const std::exception&) {
      return false;  // the scan reports the fault
    }
  };
  sources.outside += std::erase_if(sources.tiles, is_outside);
}

/// Opens mesh files. If no file has earth-centred coordinates, only SourceOptions::origin can set the origin.
SceneSources mesh_sources(const Path& root, const std::vector<Path>& files, const SourceOptions& options,
                          const Progress& progress) {
  SceneSources out;
  out.root = root;
  if (!options.local) out.origin = options.origin;
  progress.step("inspecting the files", files.size(), "file");
  for (const Path& file : files) {
    add_mesh_file(file, options, out);
    progress.advance();
  }
  place_on_earth(options, out);
  if (options.area) drop_outside(options, out);
  return out;
}

SceneSources tileset_sources(const SourceFiles& files, const Path& file, const TilesetDocument& document,
                             const SourceOptions& options, const Progress& progress) {
  SceneSources out;
  out.root = files.root();
  const Tileset tileset = open_tileset(files, file, document, volume_filter(options), progress);
  out.skipped = tileset.skipped;
  out.outside = tileset.outside;
  Affine<Scene, World> scene_from_world = local_scene(options);
  if (!options.local) out.origin = options.origin;
  TilesetPlace found = tileset_place(files, tileset);
  if (found.warning) out.notes.push_back(std::move(*found.warning));
  if (found.point && !options.local) {
    const Geodetic place = geodetic_of(*found.point);
    if (!out.origin) out.origin = place;
    if (auto warning = far_origin_warning(*out.origin, {place})) out.notes.push_back(std::move(*warning));
    scene_from_world.m = scene_from_ecef(*out.origin).m;  // this World is ECEF
  }
  if (found.point && options.local)
    out.notes.push_back(
        "warning: the tileset is placed on the earth; in a local frame (`local`, or a place in a scene "
        ".json) it is tilted and some 6,400 km away");
  progress.step("inspecting the tiles' files", tileset.contents.size(), "tile");
  Path named;
  std::string name;
  for (const TilesetContent& c : tileset.contents) {
    progress.advance();
    if (c.path != named || name.empty()) name = name_in(out.root, named = c.path);
    out.tiles.push_back({c.path, name + c.part, c.kind, c.gltf_up, scene_from_world * c.world_from_tile,
                         (c.archive ? SourceFiles(c.archive) : files).size_of(c.path), c.range, c.archive,
                         c.world_from_tile});
  }
  return out;
}

SceneSources archive_sources(const Path& file, const SourceOptions& options, const Progress& progress) {
  progress.step("reading the archive");
  const SourceFiles files(std::make_shared<const Archive>(file));
  const Path tileset = file / "tileset.json";
  if (!files.has(tileset)) throw InputError(file, "", "holds no tileset.json");
  const TilesetDocument document = parse_tileset(tileset, files.read_content(tileset), progress, tile_members(options));
  if (!document.root) throw InputError(tileset, "root", "is missing");
  return tileset_sources(files, tileset, document, options, progress);
}

SceneSources json_sources(const Path& file, const SourceOptions& options, const Progress& progress) {
  progress.step("reading " + file.filename().string());
  const TilesetDocument document =
      parse_tileset(file, SourceFiles(folder_of(file)).read_content(file), progress, tile_members(options));
  const Json& json = document.json;
  if (!json.is_object()) throw InputError(file, "", "expected a tileset.json or a scene .json");
  if (json.contains("gigabake")) return open_scene_json(file, json, options, progress);
  if (document.root) return tileset_sources(SourceFiles(folder_of(file)), file, document, options, progress);
  if (json.contains("meshes") || json.contains("nodes"))
    return mesh_sources(folder_of(file), {file}, options, progress);
  throw InputError(file, "", "expected a tileset (\"root\") or a scene (\"gigabake\")");
}

DemOptions stated_options(const RasterOptions& stated) {
  DemOptions out;
  if (!stated.ortho.empty()) out.ortho = std::filesystem::absolute(stated.ortho);  // ranks have other working folders
  out.crs = stated.dem_crs;
  out.nodata = stated.nodata;
  out.geoid_offset_m = stated.geoid_offset_m;
  return out;
}

/// Rejects statements about rasters for a source that has other files, or its own statements.
void expect_rasters(const Path& path, const RasterOptions& stated) {
  if (stated == RasterOptions{}) return;
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(path, error);
  if (is_raster_name(path) || (is_folder && !rasters_in(path).empty())) return;
  const char* field = !stated.ortho.empty() ? "ortho" : "nodata";
  if (stated.ortho.empty() && stated.nodata.empty()) field = stated.dem_crs.empty() ? "geoid_offset_m" : "dem_crs";
  throw UsageError(field, lower_extension(path) == ".json"
                              ? "the source is a .json, which states this for each of its rasters (\"dem\")"
                              : "the source is no elevation raster (.tif, .asc, .hgt, .vrt)");
}

/// Returns the rasters that can be opened. Lists files that cannot be opened, such as a photo, as skipped.
std::vector<DemOptions> readable_rasters(const Path& root, const std::vector<Path>& files, const SourceOptions& options,
                                         std::vector<SkippedSource>& skipped) {
  std::vector<DemOptions> rasters;
  std::error_code error;
  for (const Path& file : files) {
    DemOptions raster = stated_options(options.raster);
    raster.dem = file;
    if (files.size() > 1 && std::filesystem::equivalent(file, raster.ortho, error)) continue;
    if (files.size() == 1) return {raster};  // dem_sources() opens it and reports its error
    try {
      open_dem({raster}, options.local);
      rasters.push_back(raster);
    } catch (const InputError& e) {
      skipped.push_back({name_in(root, file), e.what()});
    }
  }
  if (rasters.empty()) throw InputError(root, "", "none of its rasters can be read: " + skipped.front().reason);
  return rasters;
}

/// Opens rasters. Rasters with the same pixel grid form one surface. Different surfaces are placed by their coordinate
/// systems.
SceneSources raster_sources(const Path& root, const std::vector<Path>& files, const SourceOptions& options,
                            const Progress& progress) {
  std::vector<SkippedSource> skipped;
  const std::vector<DemOptions> rasters = readable_rasters(root, files, options, skipped);
  std::vector<SceneSources> surfaces = dem_sources(root, rasters, options, progress);
  SceneSources out = std::move(surfaces.front());
  out.skipped = std::move(skipped);
  for (std::size_t i = 1; i < surfaces.size(); ++i) {
    SceneSources& surface = surfaces[i];
    if (!out.origin || !surface.origin)
      throw InputError(surface.tiles.front().path, "",
                       "its pixels are not on the grid of the first raster, so `local` cannot place them together");
    const Affine<Scene, Scene> place = scene_from_ecef(*out.origin) * ecef_from_enu(*surface.origin);
    for (TileRef& tile : surface.tiles) {
      tile.scene_from_tile = place * tile.scene_from_tile;
      out.tiles.push_back(std::move(tile));
    }
    out.notes.insert(out.notes.end(), surface.notes.begin(), surface.notes.end());
  }
  return out;
}

/// Opens a folder. If the folder has a tileset, opens only the tileset, because it has transforms and levels of detail.
SceneSources folder_sources(const Path& folder, const SourceOptions& options, const Progress& progress) {
  std::error_code error;
  if (std::filesystem::is_regular_file(folder / "tileset.json", error))
    return json_sources(folder / "tileset.json", options, progress);
  const FolderListing listing = list_folder(folder, is_mesh, progress);
  if ((listing.tileset || !listing.files.empty()) && options.raster != RasterOptions{})
    throw UsageError("ortho", "the folder has a tileset or mesh files; name the elevation raster");
  if (listing.tileset) return json_sources(*listing.tileset, options, progress);
  const std::vector<Path> rasters = listing.files.empty() ? rasters_in(folder) : std::vector<Path>();
  if (listing.files.empty() && rasters.empty())
    throw InputError(folder, "",
                     "holds no .glb, .gltf, .b3dm, .i3dm, .cmpt, .obj, .ply, .stl, .tif, .asc, .hgt or .vrt; name a "
                     "tileset.json or a scene .json" +
                         (listing.note.empty() ? "" : " (" + listing.note + ")"));
  SceneSources out = rasters.empty() ? mesh_sources(folder, listing.files, options, progress)
                                     : raster_sources(folder, rasters, options, progress);
  if (!listing.note.empty()) out.notes.push_back("warning: " + listing.note);
  return out;
}

/// Checks that the area fits the scene, and stores it in the sources.
void restrict_to_area(const std::shared_ptr<const Area>& area, SceneSources& sources) {
  const AreaInScene placed(area, sources.origin);
  sources.area = area;
  if (sources.tiles.empty() && sources.outside != 0)
    throw UsageError(fmt::format("no tile intersects the area of interest; {} outside",
                                 pluralize(sources.outside, "tile is", "tiles are")));
  if (sources.outside != 0)
    sources.notes.push_back(
        fmt::format("area of interest: {} outside and not read", pluralize(sources.outside, "tile is", "tiles are")));
}

void add_edits(const EditList& edits, SceneSources& sources) {
  if (edits.empty()) return;
  EditList all = sources.edits ? *sources.edits : EditList();
  all.insert(all.end(), edits.begin(), edits.end());
  sources.edits = std::make_shared<const EditList>(std::move(all));
}

/// Adds the edits to all tiles of a source that is no scene .json.
void add_source_edits(const NamedSourceEdits& edits, SceneSources& sources) {
  if (edits.empty()) return;
  auto all = std::make_shared<SourceEdits>();
  for (const NamedSourceEdit& edit : edits) {
    if (!edit.source.empty()) refuse(edit, "names a source, but only the sources of a scene .json have names");
    all->list.push_back(edit.edit);
  }
  placed_edits(*all, sources.origin);  // throws early if the scene has no place for them
  for (TileRef& tile : sources.tiles) tile.edits = all;
}

}  // namespace

SceneSources open_sources(const std::filesystem::path& path, const SourceOptions& options, const Progress& progress) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path, "", "no such file or folder");
  expect_rasters(path, options.raster);
  SceneSources out;
  if (std::filesystem::is_directory(path, error))
    out = folder_sources(path, options, progress);
  else if (lower_extension(path) == ".json")
    out = json_sources(path, options, progress);
  else if (lower_extension(path) == ".3tz")
    out = archive_sources(path, options, progress);
  else if (is_raster_name(path))
    out = raster_sources(folder_of(path), {path}, options, progress);
  else if (is_mesh(path))
    out = mesh_sources(folder_of(path), {path}, options, progress);
  else if (is_other_raster_name(path))
    throw InputError(path, "", "is a raster or an image that is not read; convert it with gdal_translate IN OUT.tif");
  else
    throw InputError(
        path, "",
        "expected a .glb, .gltf, .b3dm, .i3dm, .cmpt, .obj, .ply, .stl, .tif, .asc, .hgt or .vrt, a folder, "
        "a tileset.json, a .3tz or a scene .json");
  if (options.edits) add_edits(*options.edits, out);
  if (options.source_edits && !out.is_scene_json) add_source_edits(*options.source_edits, out);
  if (options.area) restrict_to_area(options.area, out);
  for (const TileRef& tile : out.tiles)
    if (!tile.scene_from_tile.is_finite()) throw InputError(tile.path, "transform", "the tile's place is not finite");
  return out;
}

}  // namespace gigabake
