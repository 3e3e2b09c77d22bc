#include "format/source/tiles/implicit_tiling.h"

#include "core/base/error.h"
#include "core/io/byte_cursor.h"
#include "core/octree/morton.h"

namespace gigabake {
namespace {

constexpr std::uint32_t max_levels = 32;
constexpr std::uint32_t max_octree_levels = 10, max_quadtree_levels = 15;  ///< 2^30 tiles per subtree
constexpr std::uint32_t subtree_magic = 0x74627573;                        // "subt"

std::uint32_t level_count(const std::filesystem::path& file, const Json& object, const std::string& where,
                          const char* key, std::uint32_t maximum) {
  const auto levels = get_index(file, object, where, key);
  if (!levels || *levels == 0 || *levels > maximum)
    throw InputError(file, where + "." + key, "expected 1 to " + std::to_string(maximum) + " levels");
  return std::uint32_t(*levels);
}

}  // namespace

std::uint64_t ImplicitTiling::index_in_level(const TileCoordinates& local) const {
  const auto x = std::uint32_t(local.x), y = std::uint32_t(local.y), z = std::uint32_t(local.z);
  return is_octree ? morton(x, y, z) : morton(x, y);
}

std::optional<ImplicitTiling> implicit_tiling(const std::filesystem::path& file, const Json& tile,
                                              const std::string& where) {
  const Json& extensions = get_object(file, tile, where, "extensions");
  const bool is_core = tile.contains("implicitTiling");
  if (!is_core && !extensions.contains("3DTILES_implicit_tiling")) return std::nullopt;
  const std::string key = where + (is_core ? ".implicitTiling" : ".extensions.3DTILES_implicit_tiling");
  const Json& json = is_core ? get_object(file, tile, where, "implicitTiling")
                             : get_object(file, extensions, where, "3DTILES_implicit_tiling");
  ImplicitTiling out;
  const std::string scheme = get_text(file, json, key, "subdivisionScheme").value_or("");
  if (scheme != "QUADTREE" && scheme != "OCTREE")
    throw InputError(file, key + ".subdivisionScheme", "expected QUADTREE or OCTREE, got " + in_quotes(scheme));
  out.is_octree = scheme == "OCTREE";
  out.subtree_levels =
      level_count(file, json, key, "subtreeLevels", out.is_octree ? max_octree_levels : max_quadtree_levels);
  // Earlier versions of the extension count from 0.
  out.available_levels =
      json.contains("maximumLevel")
          ? std::uint32_t(std::min<std::uint64_t>(get_index(file, json, key, "maximumLevel").value_or(0), max_levels)) +
                1
          : level_count(file, json, key, "availableLevels", max_levels);
  const auto uri = get_text(file, get_object(file, json, key, "subtrees"), key + ".subtrees", "uri");
  if (!uri) throw InputError(file, key + ".subtrees.uri", "is missing");
  out.subtrees_uri = *uri;
  return out;
}

std::string filled_template(const std::string& uri, const TileCoordinates& place) {
  const std::pair<const char*, std::uint64_t> variables[] = {
      {"{level}", place.level}, {"{x}", place.x}, {"{y}", place.y}, {"{z}", place.z}};
  std::string out = uri;
  for (const auto& [name, value] : variables)
    for (auto at = out.find(name); at != std::string::npos; at = out.find(name, at))
      out.replace(at, std::string_view(name).size(), std::to_string(value));
  return out;
}

/// The document of one subtree and its buffers.
class SubtreeAvailability::Reader {
 public:
  Reader(const SourceFiles& files, const std::filesystem::path& file) : files_(files), file_(file) {
    bytes_ = files.read_content(file);
    ByteCursor in{file_, bytes_, bytes_};
    if (bytes_.size() < 4 || in.word("the subtree") != subtree_magic) {
      json_ = parse_json(file, bytes_);
    } else {
      if (const std::uint32_t version = in.word("the subtree's header"); version != 1)
        in.fail("expected a subtree of version 1, got " + std::to_string(version));
      const std::uint64_t json_bytes = in.long_word("the subtree's header");
      const std::uint64_t binary_bytes = in.long_word("the subtree's header");
      json_ = parse_json(file, in.take(json_bytes, "the subtree's JSON"));
      binary_ = in.take(binary_bytes, "the subtree's binary part");
    }
    if (!json_.is_object()) throw InputError(file, "", "expected a subtree, a JSON object");
  }

  Bits tiles(const ImplicitTiling& t) const { return bits(json_, "", "tileAvailability", t.tiles_in_subtree(), true); }

  Bits children(const ImplicitTiling& t) const {
    return bits(json_, "", "childSubtreeAvailability", t.tiles_in_level(t.subtree_levels), true);
  }

  /// Availability of contents: one object, a list, or, in the extension for several contents, a list.
  std::vector<Bits> contents(const ImplicitTiling& t) const {
    const std::uint64_t count = t.tiles_in_subtree();
    const char* key = "contentAvailability";
    const Json& extension =
        get_object(file_, get_object(file_, json_, "", "extensions"), "extensions", "3DTILES_multiple_contents");
    const Json& owner = json_.contains(key) ? json_ : extension;
    if (owner.contains(key) && owner[key].is_object()) return {bits(owner, "", key, count, false)};
    std::vector<Bits> out;
    for (const Json& item : get_array(file_, owner, "", key)) out.push_back(bits_of(item, key, count));
    return out;
  }

 private:
  Bits bits(const Json& owner, const std::string& where, const char* key, std::uint64_t count, bool is_needed) const {
    if (is_needed && !owner.contains(key)) throw InputError(file_, key, "is missing");
    return bits_of(get_object(file_, owner, where, key), key, count);
  }

  Bits bits_of(const Json& availability, const std::string& where, std::uint64_t count) const {
    if (const auto constant = get_index(file_, availability, where, "constant")) return {*constant != 0, {}};
    auto view = get_index(file_, availability, where, "bitstream");
    if (!view) view = get_index(file_, availability, where, "bufferView");  // the extension's earlier name
    if (!view) throw InputError(file_, where, "expected a bitstream or a constant");
    Bits out{false, view_bytes(*view, where)};
    if (out.bytes.size() < (count + 7) / 8)
      throw InputError(file_, where, std::to_string(count) + " bits in " + std::to_string(out.bytes.size()) + " bytes");
    return out;
  }

  std::vector<std::uint8_t> view_bytes(std::uint64_t index, const std::string& where) const {
    const Json& views = get_array(file_, json_, "", "bufferViews");
    if (index >= views.size()) throw InputError(file_, where, std::to_string(index) + " is beyond the bufferViews");
    const std::string at = "bufferViews[" + std::to_string(index) + "]";
    const std::uint64_t offset = get_index(file_, views[index], at, "byteOffset").value_or(0);
    const std::uint64_t length = get_index(file_, views[index], at, "byteLength").value_or(0);
    std::vector<std::uint8_t> external;
    const std::span<const std::uint8_t> buffer =
        buffer_bytes(get_index(file_, views[index], at, "buffer").value_or(0), external);
    if (offset > buffer.size() || length > buffer.size() - offset)
      throw InputError(file_, at, "exceeds a buffer of " + std::to_string(buffer.size()) + " bytes");
    const auto bytes = buffer.subspan(offset, length);
    return {bytes.begin(), bytes.end()};
  }

  std::span<const std::uint8_t> buffer_bytes(std::uint64_t index, std::vector<std::uint8_t>& external) const {
    const Json& buffers = get_array(file_, json_, "", "buffers");
    const std::string at = "buffers[" + std::to_string(index) + "]";
    if (index >= buffers.size()) throw InputError(file_, at, "is beyond the list of buffers");
    const auto uri = get_text(file_, buffers[index], at, "uri");
    if (!uri) return binary_;
    external = files_.read_referenced(resolve_uri(files_.root(), file_, at + ".uri", *uri));
    return external;
  }

  const SourceFiles& files_;
  const std::filesystem::path& file_;
  std::vector<std::uint8_t> bytes_;
  Json json_;
  std::span<const std::uint8_t> binary_;
};

SubtreeAvailability::SubtreeAvailability(const SourceFiles& files, const std::filesystem::path& file,
                                         const ImplicitTiling& tiling, std::size_t contents) {
  const Reader reader(files, file);
  tiles_ = reader.tiles(tiling);
  children_ = reader.children(tiling);
  if (contents != 0) contents_ = reader.contents(tiling);
}

}  // namespace gigabake
