#include "format/tileset.h"

#include <algorithm>
#include <fstream>
#include <set>

#include "format/error.h"
#include "format/tileset_anchor.h"
#include "format/transform.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

constexpr std::size_t deepest_external = 32;
constexpr std::uint64_t most_tiles = std::uint64_t(1) << 24;
/// Text of external tilesets that one bake follows, each counted as at least 16 KiB: files that include others twice
/// double at every step.
constexpr std::uint64_t most_external_bytes = std::uint64_t(1) << 32, least_external_bytes = std::uint64_t(1) << 14;

enum class Refine { add, replace };

/// What a tile inherits.
struct Context {
  Path file;
  UpAxis gltf_up = UpAxis::y;
  Affine<World, World> world_from_parent;
  Refine refine = Refine::replace;
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

  Subtree read_document(const Path& file, const Json& json, Context context) {
    std::error_code error;
    const Path canonical = std::filesystem::weakly_canonical(file, error);
    if (std::find(open_files_.begin(), open_files_.end(), canonical) != open_files_.end())
      throw InputError(file, "root", "the tileset includes itself");
    if (open_files_.size() == deepest_external) throw InputError(file, "root", "external tilesets nest deeper than 32");
    const bool is_first = open_files_.empty();
    open_files_.push_back(canonical);
    check_head(file, json);
    context.file = file;
    context.gltf_up = up_axis(file, get_object(file, json, "", "asset"));
    if (is_first) out_.anchor = tileset_anchor(file, json["root"]);
    Subtree found = read_tile(json["root"], "root", context);
    open_files_.pop_back();
    return found;
  }

 private:
  static void check_head(const Path& file, const Json& json) {
    const Json& asset = get_object(file, json, "", "asset");
    const std::string version = get_text(file, asset, "asset", "version").value_or("");
    if (version != "1.0" && version != "1.1" && version != "0.0")
      throw InputError(file, "asset.version", "expected 3D Tiles 1.0 or 1.1, got " + in_quotes(version));
    static const std::set<std::string> known{"3DTILES_content_gltf", "3DTILES_multiple_contents",
                                             "3DTILES_implicit_tiling", "3DTILES_metadata",
                                             "3DTILES_bounding_volume_S2"};
    for (const Json& e : get_array(file, json, "", "extensionsRequired")) {
      const std::string name = e.is_string() ? e.get<std::string>() : e.dump();
      if (!known.contains(name))
        throw InputError(file, "extensionsRequired", "the extension " + in_quotes(name) + " is not supported");
    }
    if (!json.contains("root")) throw InputError(file, "root", "is missing");
  }

  static UpAxis up_axis(const Path& file, const Json& asset) {
    const std::string up = get_text(file, asset, "asset", "gltfUpAxis").value_or("Y");
    if (up == "X" || up == "x") return UpAxis::x;
    if (up == "Z" || up == "z") return UpAxis::z;
    if (up == "Y" || up == "y") return UpAxis::y;
    throw InputError(file, "asset.gltfUpAxis", "expected X, Y or Z, got " + in_quotes(up));
  }

  Subtree read_tile(const Json& tile, const std::string& where, const Context& parent) {
    if (++tiles_ > most_tiles) throw InputError(parent.file, where, "the tileset has more than 2^24 tiles");
    Context here = parent;
    if (const auto m = get_numbers(parent.file, tile, where, "transform", 16))
      here.world_from_parent = parent.world_from_parent * affine_from_columns<World, World>(*m);
    here.refine = refine_of(tile, where, parent);
    Subtree finer;
    const Json& children = get_array(parent.file, tile, where, "children");
    for (std::size_t i = 0; i < children.size(); ++i)
      join(finer, read_tile(children[i], where + ".children[" + std::to_string(i) + "]", here));
    if (is_implicit(tile, where, here)) {
      skip(here, where, "implicit tiling is not supported; convert it to explicit tiles", false);
      return finer;
    }
    return with_own_content(tile, where, here, std::move(finer));
  }

  static bool is_implicit(const Json& tile, const std::string& where, const Context& here) {
    return tile.contains("implicitTiling") ||
           get_object(here.file, tile, where, "extensions").contains("3DTILES_implicit_tiling");
  }

  /// The specification demands it of the root; files in use leave it out and mean REPLACE.
  static Refine refine_of(const Json& tile, const std::string& where, const Context& parent) {
    const auto text = get_text(parent.file, tile, where, "refine");
    if (!text) return parent.refine;
    if (*text == "ADD" || *text == "add") return Refine::add;
    if (*text == "REPLACE" || *text == "replace") return Refine::replace;
    throw InputError(parent.file, where + ".refine", "expected ADD or REPLACE, got " + in_quotes(*text));
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
      if (!std::filesystem::is_regular_file(path, error) || magic_of(path) != Magic::json) continue;
      if (const Json json = read_json(path); is_tileset(json)) join(found, read_document(path, json, here));
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
    const Path path = resolve_uri(root_, here.file, key, uri);
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      skip(here, key, in_quotes(uri) + " is missing", false);
      return {{}, true};
    }
    switch (magic_of(path)) {
      case Magic::glb:
        return {{content(path, ContentKind::glb, here)}, false};
      case Magic::b3dm:
        return {{content(path, ContentKind::b3dm, here)}, false};
      case Magic::json:
        if (const Json json = read_json(path); is_tileset(json)) return read_document(path, json, here);
        return {{content(path, ContentKind::gltf, here)}, false};
      case Magic::points:
        skip(here, key, in_quotes(uri) + " holds points, which have no surface", true);
        return {};
      case Magic::instances:
        skip(here, key, in_quotes(uri) + ": instanced models (i3dm) are not supported", false);
        return {};
      case Magic::composite:
        skip(here, key, in_quotes(uri) + ": composite tiles (cmpt) are not supported", false);
        return {};
      case Magic::unknown:
        break;
    }
    skip(here, key, in_quotes(uri) + " is neither glTF nor b3dm", false);
    return {{}, true};
  }

  Json read_json(const Path& path) {
    const std::vector<std::uint8_t> text = read_whole_file(path);
    external_bytes_ += std::max<std::uint64_t>(text.size(), least_external_bytes);
    if (external_bytes_ > most_external_bytes)
      throw InputError(path, "", "external tilesets include each other too often: over 4 GiB, or over 2^18 files");
    return parse_json(path, text);
  }

  static bool is_tileset(const Json& json) { return json.is_object() && json.contains("root"); }

  static TilesetContent content(const Path& path, ContentKind kind, const Context& here) {
    return {path, kind, here.gltf_up, here.world_from_parent};
  }

  static void join(Subtree& to, Subtree from) {
    if (to.contents.empty())
      to.contents = std::move(from.contents);
    else
      to.contents.insert(to.contents.end(), from.contents.begin(), from.contents.end());
    to.is_missing_some |= from.is_missing_some;
  }

  void skip(const Context& here, const std::string& key, const std::string& reason, bool informative) {
    out_.skipped.push_back({name_in(root_, here.file) + ": " + key, reason, informative});
  }

  Path root_;
  Tileset& out_;
  std::vector<Path> open_files_;  ///< from the first tileset to the one being read
  std::uint64_t tiles_ = 0, external_bytes_ = 0;
};

}  // namespace

Tileset open_tileset(const std::filesystem::path& root, const std::filesystem::path& file, const Json& json) {
  Tileset tileset;
  tileset.contents = Reader(root, tileset).read_document(file, json, {}).contents;
  return tileset;
}

}  // namespace gigabake
