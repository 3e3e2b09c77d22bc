#include "format/source/tiles/tileset_document.h"

#include <algorithm>
#include <cctype>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/math/transform.h"
#include "format/source/loss_reason.h"
#include "format/system/json/json_members.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

/// Returns the refinement that a tile states; nullopt if it states none. The specification requires `refine` in the
/// root, but some files omit it and mean REPLACE.
std::optional<Refine> refine_of(const JsonMembers& tile) {
  const auto text = tile.find<std::string>("refine");
  if (!text) return std::nullopt;
  std::string upper = *text;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  if (upper == "ADD") return Refine::add;
  if (upper == "REPLACE") return Refine::replace;
  tile.fail("refine", "expected ADD or REPLACE, got " + in_quotes(*text));
}

std::vector<std::string> content_uris(const JsonMembers& tile) {
  std::vector<std::string> uris;
  const auto add = [&](const Json& content) {
    std::string uri;
    for (const char* name : {"url", "uri"})
      if (content.is_object() && content.contains(name) && content[name].is_string()) uri = content[name];
    uris.push_back(uri);
  };
  if (const Json* content = tile.value("content")) add(*content);
  const auto add_all = [&](const Json& list) {
    for (const Json& content : list) add(content);
  };
  add_all(tile.array("contents"));
  const JsonMembers multiple = tile.members("extensions").members("3DTILES_multiple_contents");
  add_all(multiple.array("content"));
  add_all(multiple.array("contents"));
  return uris;
}

void read_members(const JsonMembers& json, TilesetTile& tile) {
  if (const auto m = json.numbers<16>("transform"))
    tile.world_from_tile = std::make_unique<const Affine<World, World>>(affine_from_columns<World, World>(*m));
  tile.refine = refine_of(json);
  tile.bad_children = json.array("children").size();  // children that are objects have been removed
  tile.uris = content_uris(json);
  if (auto tiling = implicit_tiling(json)) tile.implicit = std::make_unique<const ImplicitTiling>(std::move(*tiling));
}

TilesetTile tile_of(const Path& file, const Json& json, const std::string& where, TileMembers members) {
  TilesetTile tile;
  try {
    read_members(JsonMembers(file, json, where), tile);
    if (members == TileMembers::all)
      if (const auto volume = bounding_volume(JsonMembers(file, json, where)))
        tile.volume = std::make_unique<const BoundingVolume>(*volume);
  } catch (const InputError& e) {
    tile.fault = std::make_unique<const std::string>(reason_without_place(e.what(), file, ""));
  }
  return tile;
}

/// A collector of tiles. It removes each tile from the document once the tile is complete, children before their
/// parent.
class TileCollector {
 public:
  TileCollector(const Path& file, TileMembers members) : file_(file), members_(members), memory_(file) {}

  bool fold(const std::vector<OpenJson>& around, Json& complete) {
    if (!is_tile(around)) return false;
    const std::size_t depth = around.size() / 2;  // number of levels below the root
    below_.resize(std::max(below_.size(), depth + 2));
    TilesetTile tile = tile_of(file_, complete, where_of(around), members_);
    tile.children = std::move(below_[depth + 1]);
    below_[depth + 1].clear();
    if (depth > 0 && around.back().items == 0) below_[depth].clear();  // `children` occurs twice; the last list counts
    memory_.add(bytes_of(tile), "", "the tiles of the tileset");
    below_[depth].push_back(std::move(tile));
    return depth > 0;
  }

  std::optional<TilesetTile> root() {
    if (below_.empty() || below_[0].empty()) return std::nullopt;
    return std::move(below_[0].back());
  }

 private:
  /// Returns whether the complete object is a tile: root, root.children[i], root.children[i].children[j], …
  static bool is_tile(const std::vector<OpenJson>& around) {
    if (around.size() % 2 == 0 || around[0].key != "root") return false;
    for (std::size_t i = around.size() - 1; i >= 2; i -= 2)
      if (!around[i].value.is_array() || around[i - 1].key != "children") return false;
    return true;
  }

  static std::string where_of(const std::vector<OpenJson>& around) {
    std::string where = "root";
    for (std::size_t i = 2; i < around.size(); i += 2) where += ".children[" + std::to_string(around[i].items) + "]";
    return where;
  }

  static std::uint64_t bytes_of(const TilesetTile& tile) {
    constexpr std::uint64_t text_bytes = 64;
    std::uint64_t bytes = 2 * sizeof tile;  // lists grow by doubling
    for (const std::string& uri : tile.uris) bytes += text_bytes + uri.size();
    if (tile.world_from_tile) bytes += sizeof *tile.world_from_tile;
    if (tile.volume) bytes += sizeof *tile.volume;
    if (tile.implicit) bytes += sizeof *tile.implicit + tile.implicit->subtrees_uri.size();
    return bytes;
  }

  const Path& file_;
  TileMembers members_;
  MemoryClaim memory_;
  std::vector<std::vector<TilesetTile>> below_;  ///< complete tiles with an incomplete parent, by depth
};

void add_uris_below(const TilesetTile& tile, std::vector<std::string>& uris) {
  uris.insert(uris.end(), tile.uris.begin(), tile.uris.end());
  for (const TilesetTile& child : tile.children) add_uris_below(child, uris);
}

}  // namespace

std::vector<std::string> uris_below(const TilesetTile& tile) {
  std::vector<std::string> uris;
  add_uris_below(tile, uris);
  return uris;
}

std::uint64_t contents_below(const TilesetTile& tile) {
  const std::vector<std::string> uris = uris_below(tile);
  return std::uint64_t(std::count_if(uris.begin(), uris.end(),
                                     [](const std::string& uri) { return !uri.empty() && !uri.ends_with(".pnts"); }));
}

TilesetDocument parse_tileset(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                              const Progress& progress, TileMembers members) {
  TileCollector tiles(file, members);
  TilesetDocument out;
  out.json = parse_json(file, text, [&](const std::vector<OpenJson>& around, Json& complete) {
    progress.advance(0);
    return tiles.fold(around, complete);
  });
  if (out.json.is_object() && out.json.contains("root")) {
    if (!out.json["root"].is_object()) throw InputError(file, "root", "expected a JSON object");
    out.root = tiles.root();
  }
  return out;
}

}  // namespace gigabake
