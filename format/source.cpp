#include "format/source.h"

#include <algorithm>

#include "format/error.h"
#include "format/georeference.h"
#include "format/scene_json.h"
#include "format/source_file.h"
#include "format/tileset.h"
#include "format/transform.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

Path folder_of(const Path& file) { return file.has_parent_path() ? file.parent_path() : Path("."); }

std::uint64_t size_of(const Path& path) {
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

/// The source's own frame to the local scene: z up unless told otherwise.
Affine<Scene, World> local_scene(const SourceOptions& options) {
  return z_up_from<Scene, World>(options.scene_up.value_or(UpAxis::z));
}

TileRef mesh_file(const Path& root, const Path& path, const SourceOptions& options) {
  const ContentKind kind = lower_extension(path) == ".b3dm"   ? ContentKind::b3dm
                           : lower_extension(path) == ".gltf" ? ContentKind::gltf
                                                              : ContentKind::glb;
  return {path, name_in(root, path), kind, options.scene_up.value_or(UpAxis::y), {}, size_of(path)};
}

bool is_mesh(const Path& path) {
  const std::string e = lower_extension(path);
  return e == ".glb" || e == ".gltf" || e == ".b3dm";
}

/// A mesh file has no place on the earth of its own; --origin says where its local frame stands.
SceneSources mesh_sources(const Path& root, const std::vector<Path>& files, const SourceOptions& options) {
  SceneSources out;
  out.root = root;
  if (!options.local) out.origin = options.origin;
  for (const Path& file : files) out.tiles.push_back(mesh_file(root, file, options));
  return out;
}

SceneSources tileset_sources(const Path& file, const Json& json, const SourceOptions& options) {
  SceneSources out;
  out.root = folder_of(file);
  const Tileset tileset = open_tileset(out.root, file, json);
  out.skipped = tileset.skipped;
  Affine<Scene, World> scene_from_world = local_scene(options);
  if (!options.local) out.origin = options.origin;
  if (tileset.anchor && !options.local) {
    if (!out.origin) out.origin = geodetic_of(*tileset.anchor);
    scene_from_world.m = scene_from_ecef(*out.origin).m;  // this World is the earth
  }
  for (const TilesetContent& c : tileset.contents)
    out.tiles.push_back(
        {c.path, name_in(out.root, c.path), c.kind, c.gltf_up, scene_from_world * c.world_from_tile, size_of(c.path)});
  return out;
}

SceneSources json_sources(const Path& file, const SourceOptions& options) {
  const Json json = parse_json(file, read_whole_file(file));
  if (!json.is_object()) throw InputError(file, "", "expected a tileset.json or a scene .json");
  if (json.contains("gigabake")) return open_scene_json(file, json, options);
  if (json.contains("root")) return tileset_sources(file, json, options);
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
    throw InputError(folder, "", "holds no .glb, .gltf or .b3dm; name a tileset.json or a scene .json");
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
  else if (is_mesh(path))
    out = mesh_sources(folder_of(path), {path}, options);
  else
    throw InputError(path, "", "expected a .glb, a .gltf, a folder of them, a tileset.json or a scene .json");
  for (const TileRef& tile : out.tiles)
    if (!tile.scene_from_tile.is_finite()) throw InputError(tile.path, "transform", "the tile's place is not finite");
  return out;
}

}  // namespace gigabake
