#include "format/tileset.h"

#include <algorithm>
#include <fstream>
#include <set>

#include "format/error.h"
#include "format/georeference.h"
#include "format/source_file.h"
#include "format/transform.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

constexpr std::uint64_t largest_tileset_bytes = std::uint64_t(1) << 30;
constexpr int deepest_external = 64;

enum class Refine { add, replace };

/// What a tile inherits.
struct Context {
  Path file;
  UpAxis gltf_up = UpAxis::y;
  Affine<World, World> world_from_parent;
  Refine refine = Refine::replace;
  std::set<Path> open_files;
};

/// The finest contents of a subtree.
struct Subtree {
  std::vector<TilesetContent> contents;
  bool is_missing_some = false;  ///< a finest content is missing and nothing below stood in for it
};

enum class Magic { glb, b3dm, json, points, instances, composite, unknown };

Magic magic_of(const Path& path) {
  char head[4] = {};
  std::ifstream(path, std::ios::binary).read(head, 4);
  const std::string_view magic(head, 4);
  if (magic == "glTF") return Magic::glb;
  if (magic == "b3dm") return Magic::b3dm;
  if (magic == "pnts") return Magic::points;
  if (magic == "i3dm") return Magic::instances;
  if (magic == "cmpt") return Magic::composite;
  const auto first = magic.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && magic[first] == '{' ? Magic::json : Magic::unknown;
}

class Reader {
 public:
  Reader(Path root, Tileset& out) : root_(std::move(root)), out_(out) {}

  Subtree read_file(const Path& file, Context context) {
    if (!context.open_files.insert(file).second) throw InputError(file, "root", "the tileset includes itself");
    if (context.open_files.size() > deepest_external)
      throw InputError(file, "root", "external tilesets nest deeper than 64");
    return read_document(file, parse_json(file, read_whole_file(file, largest_tileset_bytes)), std::move(context));
  }

 private:
  Subtree read_document(const Path& file, const Json& json, Context context) {
    const Json& asset = get_object(file, json, "", "asset");
    const std::string version = get_text(file, asset, "asset", "version").value_or("");
    if (version != "1.0" && version != "1.1" && version != "0.0")
      throw InputError(file, "asset.version", "expected 3D Tiles 1.0 or 1.1, got '" + version + "'");
    check_extensions(file, json);
    context.file = file;
    context.gltf_up = up_axis(file, asset);
    if (!json.contains("root")) throw InputError(file, "root", "is missing");
    if (out_first_) note_anchor(file, json["root"]);
    out_first_ = false;
    return read_tile(json["root"], "root", context, true);
  }

  static void check_extensions(const Path& file, const Json& json) {
    static const std::set<std::string> known{"3DTILES_content_gltf", "3DTILES_multiple_contents",
                                             "3DTILES_implicit_tiling", "3DTILES_metadata",
                                             "3DTILES_bounding_volume_S2"};
    for (const Json& e : get_array(file, json, "", "extensionsRequired")) {
      const std::string name = e.is_string() ? e.get<std::string>() : e.dump();
      if (!known.contains(name))
        throw InputError(file, "extensionsRequired", "the extension " + name + " is not supported");
    }
  }

  static UpAxis up_axis(const Path& file, const Json& asset) {
    const std::string up = get_text(file, asset, "asset", "gltfUpAxis").value_or("Y");
    if (up == "X" || up == "x") return UpAxis::x;
    if (up == "Z" || up == "z") return UpAxis::z;
    if (up == "Y" || up == "y") return UpAxis::y;
    throw InputError(file, "asset.gltfUpAxis", "expected X, Y or Z, got '" + up + "'");
  }

  /// Where the root's transform, or else the centre of its bounding volume, puts it.
  void note_anchor(const Path& file, const Json& root) {
    const auto transform = get_numbers(file, root, "root", "transform", 16);
    const auto map = transform ? affine_from_columns<World, World>(*transform) : Affine<World, World>();
    const auto try_point = [&](const Point<World>& p) {
      const Point<Ecef> p_ecef{p.x, p.y, p.z};
      if (!out_.anchor && is_on_earth(p_ecef)) out_.anchor = p_ecef;
    };
    try_point(map({0, 0, 0}));
    const Json& volume = get_object(file, root, "root", "boundingVolume");
    if (const auto box = get_numbers(file, volume, "root.boundingVolume", "box", 12))
      try_point(map({(*box)[0], (*box)[1], (*box)[2]}));
    if (const auto sphere = get_numbers(file, volume, "root.boundingVolume", "sphere", 4))
      try_point(map({(*sphere)[0], (*sphere)[1], (*sphere)[2]}));
    if (const auto r = get_numbers(file, volume, "root.boundingVolume", "region", 6); r && !out_.anchor) {
      constexpr double degrees = 57.295779513082321;
      out_.anchor = ecef_of({((*r)[1] + (*r)[3]) / 2 * degrees, ((*r)[0] + (*r)[2]) / 2 * degrees, (*r)[4]});
    }
  }

  Subtree read_tile(const Json& tile, const std::string& where, const Context& parent, bool is_root) {
    Context here = parent;
    if (const auto m = get_numbers(parent.file, tile, where, "transform", 16))
      here.world_from_parent = parent.world_from_parent * affine_from_columns<World, World>(*m);
    here.refine = refine_of(tile, where, parent, is_root);
    Subtree finer;
    const Json& children = get_array(parent.file, tile, where, "children");
    for (std::size_t i = 0; i < children.size(); ++i)
      join(finer, read_tile(children[i], where + ".children[" + std::to_string(i) + "]", here, false));
    if (tile.contains("implicitTiling"))
      skip(here.file, where, "implicit tiling is not supported; convert it to explicit tiles", false);
    return with_own_content(tile, where, here, std::move(finer));
  }

  static Refine refine_of(const Json& tile, const std::string& where, const Context& parent, bool is_root) {
    const auto text = get_text(parent.file, tile, where, "refine");
    if (!text) {
      // The specification demands it of the root; files in use leave it out and mean REPLACE.
      return is_root && parent.open_files.size() == 1 ? Refine::replace : parent.refine;
    }
    if (*text == "ADD" || *text == "add") return Refine::add;
    if (*text == "REPLACE" || *text == "replace") return Refine::replace;
    throw InputError(parent.file, where + ".refine", "expected ADD or REPLACE, got '" + *text + "'");
  }

  Subtree with_own_content(const Json& tile, const std::string& where, const Context& here, Subtree finer) {
    const std::vector<std::string> uris = content_uris(here.file, tile, where);
    const bool is_leaf = finer.contents.empty() && !finer.is_missing_some;
    if (here.refine == Refine::replace && !is_leaf && !finer.is_missing_some) {
      join(finer, external_only(uris, where, here));
      return finer;
    }
    const std::size_t listed = out_.skipped.size();
    Subtree own;
    for (const std::string& uri : uris) join(own, read_content(uri, where, here));
    if (here.refine == Refine::add) {
      join(own, std::move(finer));
      own.is_missing_some = false;
      return own;
    }
    if (is_leaf) return own;
    if (!own.contents.empty() && !own.is_missing_some) return own;  // stands in for its whole subtree
    out_.skipped.resize(listed);                                    // it was not needed: what is finer stays
    finer.is_missing_some = true;
    return finer;
  }

  /// External tilesets are a way to write children: they count although the tile has finer content of its own.
  Subtree external_only(const std::vector<std::string>& uris, const std::string& where, const Context& here) {
    Subtree found;
    for (const std::string& uri : uris) {
      const Path path = resolve_uri(root_, here.file, where + ".content.uri", uri);
      std::error_code error;
      if (std::filesystem::is_regular_file(path, error) && magic_of(path) == Magic::json && is_tileset(path))
        join(found, read_file(path, here));
    }
    return found;
  }

  static std::vector<std::string> content_uris(const Path& file, const Json& tile, const std::string& where) {
    std::vector<std::string> uris;
    const auto add = [&](const Json& content, const std::string& key) {
      auto uri = get_text(file, content, key, "uri");
      if (!uri) uri = get_text(file, content, key, "url");
      if (!uri) throw InputError(file, key + ".uri", "is missing");
      uris.push_back(*uri);
    };
    if (tile.contains("content") && !tile["content"].is_null()) add(tile["content"], where + ".content");
    const auto add_all = [&](const Json& list, const std::string& key) {
      for (std::size_t i = 0; i < list.size(); ++i) add(list[i], key + "[" + std::to_string(i) + "]");
    };
    add_all(get_array(file, tile, where, "contents"), where + ".contents");
    const Json& extensions = get_object(file, tile, where, "extensions");
    const Json& multiple = get_object(file, extensions, where + ".extensions", "3DTILES_multiple_contents");
    add_all(get_array(file, multiple, where + ".extensions", "content"), where + ".extensions.content");
    add_all(get_array(file, multiple, where + ".extensions", "contents"), where + ".extensions.contents");
    return uris;
  }

  Subtree read_content(const std::string& uri, const std::string& where, const Context& here) {
    const std::string key = where + ".content.uri";
    if (uri.find('{') != std::string::npos) return {};  // the template of an implicit tile, listed already
    const Path path = resolve_uri(root_, here.file, key, uri);
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      skip(here.file, key, "'" + uri + "' is missing", false);
      return {{}, true};
    }
    switch (magic_of(path)) {
      case Magic::glb:
        return {{content(path, ContentKind::glb, here)}, false};
      case Magic::b3dm:
        return {{content(path, ContentKind::b3dm, here)}, false};
      case Magic::json:
        if (is_tileset(path)) return read_file(path, here);
        return {{content(path, ContentKind::gltf, here)}, false};
      case Magic::points:
        skip(here.file, key, "'" + uri + "' holds points, which have no surface", true);
        return {};
      case Magic::instances:
        skip(here.file, key, "'" + uri + "': instanced models (i3dm) are not supported", false);
        return {};
      case Magic::composite:
        skip(here.file, key, "'" + uri + "': composite tiles (cmpt) are not supported", false);
        return {};
      case Magic::unknown:
        break;
    }
    skip(here.file, key, "'" + uri + "' is neither glTF nor b3dm", false);
    return {{}, true};
  }

  static bool is_tileset(const Path& path) {
    const Json json = parse_json(path, read_whole_file(path, largest_tileset_bytes));
    return json.is_object() && json.contains("root");
  }

  static TilesetContent content(const Path& path, ContentKind kind, const Context& here) {
    return {path, kind, here.gltf_up, here.world_from_parent};
  }

  static void join(Subtree& to, Subtree from) {
    to.contents.insert(to.contents.end(), from.contents.begin(), from.contents.end());
    to.is_missing_some |= from.is_missing_some;
  }

  void skip(const Path& file, const std::string& key, const std::string& reason, bool informative) {
    out_.skipped.push_back({name_in(root_, file) + ": " + key, reason, informative});
  }

  Path root_;
  Tileset& out_;
  bool out_first_ = true;
};

}  // namespace

Tileset open_tileset(const std::filesystem::path& root, const std::filesystem::path& file) {
  Tileset tileset;
  Reader reader(root, tileset);
  tileset.contents = reader.read_file(std::filesystem::weakly_canonical(file), {}).contents;
  return tileset;
}

}  // namespace gigabake
