#include "format/source.h"

#include <algorithm>
#include <map>

#include "format/dem_source.h"
#include "format/error.h"
#include "format/georeference.h"
#include "format/scene_json.h"
#include "format/source_file.h"
#include "format/source_files.h"
#include "format/tileset.h"
#include "format/transform.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

Path folder_of(const Path& file) { return file.has_parent_path() ? file.parent_path() : Path("."); }

/// The source's own frame to the local scene: z up unless told otherwise.
Affine<Scene, World> local_scene(const SourceOptions& options) {
  return z_up_from<Scene, World>(options.scene_up.value_or(UpAxis::z));
}

/// By extension; nothing where the file is no content.
std::optional<ContentKind> kind_of(const Path& path) {
  static const std::map<std::string, ContentKind> kinds{{".glb", ContentKind::glb},
                                                        {".gltf", ContentKind::gltf},
                                                        {".b3dm", ContentKind::b3dm},
                                                        {".i3dm", ContentKind::i3dm},
                                                        {".obj", ContentKind::obj}};
  const auto at = kinds.find(lower_extension(path));
  return at == kinds.end() ? std::nullopt : std::optional(at->second);
}

bool is_mesh(const Path& path) { return kind_of(path) || lower_extension(path) == ".cmpt"; }

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
  for (const CompositePart& part : parts_of_composite(path, files.read_content(path))) {
    TileRef inner = tile;
    inner.name += part.name;
    inner.range = part.range;
    inner.kind = part.magic == ContentMagic::i3dm ? ContentKind::i3dm : ContentKind::b3dm;
    if (part.magic == ContentMagic::points)
      out.skipped.push_back({inner.name, "holds points, which have no surface", true});
    else
      out.tiles.push_back(std::move(inner));
  }
}

/// A mesh file has no place on the earth of its own; --origin says where its local frame stands.
SceneSources mesh_sources(const Path& root, const std::vector<Path>& files, const SourceOptions& options) {
  SceneSources out;
  out.root = root;
  if (!options.local) out.origin = options.origin;
  for (const Path& file : files) add_mesh_file(file, options, out);
  return out;
}

SceneSources tileset_sources(const SourceFiles& files, const Path& file, const Json& json,
                             const SourceOptions& options) {
  SceneSources out;
  out.root = files.root();
  const Tileset tileset = open_tileset(files, file, json);
  out.skipped = tileset.skipped;
  Affine<Scene, World> scene_from_world = local_scene(options);
  if (!options.local) out.origin = options.origin;
  if (tileset.anchor && !options.local) {
    if (!out.origin) out.origin = geodetic_of(*tileset.anchor);
    scene_from_world.m = scene_from_ecef(*out.origin).m;  // this World is the earth
  }
  for (const TilesetContent& c : tileset.contents)
    out.tiles.push_back(
        {c.path, name_in(out.root, c.path) + c.part, c.kind, c.gltf_up, scene_from_world * c.world_from_tile,
         (c.archive ? SourceFiles(c.archive) : files).size_of(c.path), c.range, c.archive, c.world_from_tile});
  return out;
}

SceneSources archive_sources(const Path& file, const SourceOptions& options) {
  const SourceFiles files(std::make_shared<const Archive>(file));
  const Path tileset = file / "tileset.json";
  if (!files.has(tileset)) throw InputError(file, "", "holds no tileset.json");
  const Json json = parse_json(tileset, files.read_content(tileset));
  if (!json.is_object() || !json.contains("root")) throw InputError(tileset, "root", "is missing");
  return tileset_sources(files, tileset, json, options);
}

SceneSources json_sources(const Path& file, const SourceOptions& options) {
  const Json json = parse_json(file, SourceFiles(folder_of(file)).read_content(file));
  if (!json.is_object()) throw InputError(file, "", "expected a tileset.json or a scene .json");
  if (json.contains("gigabake")) return open_scene_json(file, json, options);
  if (json.contains("root")) return tileset_sources(SourceFiles(folder_of(file)), file, json, options);
  if (json.contains("meshes") || json.contains("nodes")) return mesh_sources(folder_of(file), {file}, options);
  throw InputError(file, "", "expected a tileset (\"root\") or a scene (\"gigabake\")");
}

/// A folder with a tileset.json is that tileset: its tiles have places and several levels of detail.
SceneSources folder_sources(const Path& folder, const SourceOptions& options) {
  std::vector<Path> files;
  std::error_code error;
  if (std::filesystem::is_regular_file(folder / "tileset.json", error))
    return json_sources(folder / "tileset.json", options);
  const auto flags = std::filesystem::directory_options::none;
  for (std::filesystem::recursive_directory_iterator it(folder, flags, error), end; !error && it != end;
       it.increment(error))
    if (it->is_regular_file(error) && !it->is_symlink(error)) {
      if (it->path().filename() == "tileset.json")
        throw InputError(it->path(), "",
                         "is a tileset inside the folder; name it, or list the sources in a scene .json");
      if (is_mesh(it->path())) files.push_back(it->path());
    }
  if (error) throw InputError(folder, "", "cannot be listed: " + error.message());
  if (files.empty())
    throw InputError(folder, "",
                     "holds no .glb, .gltf, .b3dm, .i3dm, .cmpt or .obj; name a tileset.json or a scene .json");
  std::sort(files.begin(), files.end());
  return mesh_sources(folder, files, options);
}

}  // namespace

SceneSources open_sources(const std::filesystem::path& path, const SourceOptions& options) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path, "", "no such file or folder");
  SceneSources out;
  if (std::filesystem::is_directory(path, error))
    out = folder_sources(path, options);
  else if (lower_extension(path) == ".json")
    out = json_sources(path, options);
  else if (lower_extension(path) == ".3tz")
    out = archive_sources(path, options);
  else if (lower_extension(path) == ".tif" || lower_extension(path) == ".tiff")
    out =
        dem_sources(folder_of(path), {.dem = path, .ortho = {}, .crs = {}, .nodata = {}, .height_scale = {}}, options);
  else if (is_mesh(path))
    out = mesh_sources(folder_of(path), {path}, options);
  else
    throw InputError(
        path, "",
        "expected a .glb, .gltf, .b3dm, .i3dm, .cmpt, .obj or .tif, a folder of them, a tileset.json or its .3tz "
        "archive, or a scene .json");
  for (const TileRef& tile : out.tiles)
    if (!tile.scene_from_tile.is_finite()) throw InputError(tile.path, "transform", "the tile's place is not finite");
  return out;
}

}  // namespace gigabake
