#include "app/options/scene_argument.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <string_view>

#include "app/options/name_typo.h"
#include "app/process/missing_report.h"
#include "core/base/error.h"
#include "core/base/quote.h"

namespace gigabake::app {
namespace {

namespace fs = std::filesystem;

enum class Named { baked_scene, baked_folder, begun_folder, shard, source, source_folder, unknown };

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool has_source_suffix(const fs::path& path) {
  std::string suffix = path.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  constexpr std::array<std::string_view, 13> suffixes{".glb", ".gltf", ".obj",  ".b3dm", ".i3dm", ".cmpt", ".pnts",
                                                      ".3tz", ".json", ".tiff", ".tif",  ".ply",  ".stl"};
  return std::find(suffixes.begin(), suffixes.end(), suffix) != suffixes.end();
}

Named kind_of_folder(const fs::path& folder) {
  if (is_file(folder / "scene.xml")) return Named::baked_folder;
  if (is_folder(folder / "shards") || is_file(folder / "journal")) return Named::begun_folder;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (has_source_suffix(it->path())) return Named::source_folder;
  return Named::unknown;
}

/// Classifies a file by its first bytes, then by its suffix.
Named kind_of_file(const fs::path& path) {
  std::string head(1024, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), std::streamsize(head.size()));
  head.resize(std::size_t(file.gcount()));
  if (head.starts_with("\x89HDF\r\n\x1a\n")) return Named::shard;
  if (head.find("<OctTreeGroup") != std::string::npos) return Named::baked_scene;
  return has_source_suffix(path) ? Named::source : Named::unknown;
}

Named kind_of(const fs::path& path) {
  if (is_folder(path)) return kind_of_folder(path);
  return is_file(path) ? kind_of_file(path) : Named::unknown;
}

[[noreturn]] void refuse_shard(const fs::path& shard) {
  const fs::path scene = fs::absolute(shard).lexically_normal().parent_path().parent_path() / "scene.xml";
  throw InputError(shard, "",
                   "is an HDF5 file, such as the shard of one cell; name its scene" +
                       (is_file(scene) ? ": " + short_path(scene.string()) : std::string(", SCENE/scene.xml")));
}

void expect_baked(const fs::path& given, Named kind) {
  if (kind == Named::shard) refuse_shard(given);
  if (kind == Named::source || kind == Named::source_folder)
    throw InputError(given, "",
                     "is not a scene but a source; bake it first (gigabake bake SOURCE -o SCENE --voxel-size 0.25), "
                     "then name SCENE");
  if (kind == Named::unknown && is_folder(given))
    throw InputError(given, "", "has no scene.xml; expected the folder of a bake, or its scene.xml");
}

/// Returns the first source in the folder, or an empty path. Ignores .json files except tileset.json, because they may
/// be reports.
fs::path first_source_in(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (has_source_suffix(it->path()) && (it->path().extension() != ".json" || it->path().filename() == "tileset.json"))
      return it->path().filename();
  return {};
}

bool is_bake(const fs::path& folder) {
  return is_file(folder / "scene.xml") || is_folder(folder / "shards") || is_file(folder / "journal");
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

/// Returns a bake's folder next to `out` whose name differs from that of `out` by a typo; empty if there is none.
fs::path similar_bake(const fs::path& out, const fs::path& parent) {
  const std::string name = out.filename().string();
  std::error_code error;
  for (fs::directory_iterator it(parent, error), end; !error && it != end; it.increment(error)) {
    if (!looks_like_typo(name, it->path().filename().string())) continue;
    const Named kind = kind_of(it->path());
    if (kind == Named::baked_folder || kind == Named::begun_folder) return it->path();
  }
  return {};
}

/// Returns SCENE/scene.xml of a bake that has not started yet.
/// Errors  InputError: a name that looks like a typo, or that cannot become the folder of a bake.
fs::path future_scene(const fs::path& given) {
  const bool names_scene = given.filename() == "scene.xml" || !given.has_filename();
  const fs::path named = names_scene ? given.parent_path() : given;
  const fs::path out = named.empty() ? fs::path(".") : named;
  if (is_folder(out)) return out / "scene.xml";
  if (is_there(out)) throw InputError(out, "", "is not a folder; expected the folder of a bake, or its scene.xml");
  if (has_source_suffix(out) || out.extension() == ".xml" || out.extension() == ".h5")
    throw InputError(out, "", "no such file; expected the folder of a bake, or its scene.xml");
  const fs::path parent = out.has_parent_path() ? out.parent_path() : fs::path(".");
  if (!is_folder(parent))
    throw InputError(out, "", "its folder does not exist; expected the folder of a bake, finished or not yet started");
  const fs::path similar = similar_bake(out, parent);
  if (!similar.empty())
    throw InputError(out, "", "no such folder; is " + similar.string() + " meant? To wait for a bake, make the folder");
  return out / "scene.xml";
}

}  // namespace

void expect_bake_output(const std::string& given) {
  if (!is_folder(given) || is_bake(given)) return;
  std::error_code error;
  for (fs::path inner = fs::weakly_canonical(fs::absolute(given, error), error); inner.has_relative_path();
       inner = inner.parent_path())
    if ((inner.filename() == "shards" || inner.filename() == "pages" || inner.filename() == "scratch") &&
        is_bake(inner.parent_path()))
      throw InputError(given, "",
                       "belongs to the bake in " + short_path(inner.parent_path().string()) + "; name another folder");
  if (const fs::path source = first_source_in(given); !source.empty())
    throw InputError(given, "", "holds sources (" + in_quotes(source.string()) + "); name a new or empty folder");
}

std::filesystem::path scene_argument(const std::string& given) {
  const Named kind = kind_of(given);
  expect_baked(given, kind);
  if (kind == Named::begun_folder)
    throw InputError(given, "", "has no scene.xml yet: no bake has ended there; gigabake status prints its progress");
  fs::path scene = kind == Named::baked_folder ? fs::path(given) / "scene.xml" : fs::path(given);
  record_missing_data(scene);
  return scene;
}

std::filesystem::path live_scene_argument(const std::string& given) {
  const Named kind = kind_of(given);
  if (!is_there(given)) return future_scene(given);
  if (kind == Named::unknown && is_file(given))
    throw InputError(given, "", "is not a scene; expected the folder of a bake, or its scene.xml");
  if (kind == Named::unknown && is_folder(given)) return fs::path(given) / "scene.xml";
  return kind == Named::begun_folder ? fs::path(given) / "scene.xml" : scene_argument(given);
}

std::filesystem::path bake_folder_argument(const std::string& given) {
  const Named kind = kind_of(given);
  if (!is_folder(given)) expect_baked(given, kind);
  const fs::path folder = fs::path(given).parent_path();
  return kind != Named::baked_scene ? fs::path(given) : folder.empty() ? fs::path(".") : folder;
}

void expect_source(const std::string& given) {
  const Named kind = kind_of(given);
  if (kind == Named::baked_scene || kind == Named::baked_folder || kind == Named::begun_folder)
    throw InputError(given, "",
                     "is not a source but the result of a bake; name the .glb, tileset.json or folder that was baked, "
                     "or show the result with gigabake render or view");
  if (kind == Named::shard)
    throw InputError(
        given, "",
        "is not a source but an HDF5 file, such as the shard of one baked cell; name the .glb, tileset.json or "
        "folder that was baked");
}

}  // namespace gigabake::app
