#include "format/source/tiles/implicit_tiling.h"

#include "core/base/error.h"
#include "core/io/byte_cursor.h"
#include "core/octree/morton.h"

namespace gigabake {
namespace {

constexpr std::uint32_t max_levels = 32;
constexpr std::uint32_t max_octree_levels = 10, max_quadtree_levels = 15;  ///< 2^30 tiles per subtree
constexpr std::uint32_t subtree_magic = 0x74627573;                        // "subt"

std::uint32_t level_count(const JsonMembers& tiling, const char* key, std::uint32_t maximum) {
  const auto levels = tiling.find<std::uint64_t>(key);
  if (!levels || *levels == 0 || *levels > maximum)
    tiling.fail(key, "expected 1 to " + std::to_string(maximum) + " levels");
  return std::uint32_t(*levels);
}

}  // namespace

std::uint64_t ImplicitTiling::index_in_level(const TileCoordinates& local) const {
  const auto x = std::uint32_t(local.x), y = std::uint32_t(local.y), z = std::uint32_t(local.z);
  return is_octree ? morton(x, y, z) : morton(x, y);
}

std::optional<ImplicitTiling> implicit_tiling(const JsonMembers& tile) {
  const JsonMembers extensions = tile.members("extensions");
  const bool is_core = tile.contains("implicitTiling");
  if (!is_core && !extensions.contains("3DTILES_implicit_tiling")) return std::nullopt;
  const JsonMembers json = is_core ? tile.members("implicitTiling") : extensions.members("3DTILES_implicit_tiling");
  ImplicitTiling out;
  const std::string scheme = json.find<std::string>("subdivisionScheme").value_or("");
  if (scheme != "QUADTREE" && scheme != "OCTREE")
    json.fail("subdivisionScheme", "expected QUADTREE or OCTREE, got " + in_quotes(scheme));
  out.is_octree = scheme == "OCTREE";
  out.subtree_levels = level_count(json, "subtreeLevels", out.is_octree ? max_octree_levels : max_quadtree_levels);
  // Earlier versions of the extension have `maximumLevel`, which is counted from 0.
  out.available_levels =
      json.contains("maximumLevel")
          ? std::uint32_t(std::min<std::uint64_t>(json.find<std::uint64_t>("maximumLevel").value_or(0), max_levels)) + 1
          : level_count(json, "availableLevels", max_levels);
  out.subtrees_uri = json.members("subtrees").get<std::string>("uri");
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

  Bits tiles(const ImplicitTiling& t) const { return bits("tileAvailability", t.tiles_in_subtree()); }

  Bits children(const ImplicitTiling& t) const {
    return bits("childSubtreeAvailability", t.tiles_in_level(t.subtree_levels));
  }

  /// Returns the availability of each content. The JSON has one object or a list, in the subtree or in the extension
  /// for several contents.
  std::vector<Bits> contents(const ImplicitTiling& t) const {
    const std::uint64_t count = t.tiles_in_subtree();
    const char* key = "contentAvailability";
    const JsonMembers subtree(file_, json_),
        extension = subtree.members("extensions").members("3DTILES_multiple_contents");
    const JsonMembers& owner = subtree.contains(key) ? subtree : extension;
    if (const Json* one = owner.value(key); one != nullptr && one->is_object())
      return {bits_of(owner.members(key), count)};
    std::vector<Bits> out;
    const Json& list = owner.array(key);
    for (std::size_t i = 0; i < list.size(); ++i) out.push_back(bits_of(owner.element(key, list, i), count));
    return out;
  }

 private:
  Bits bits(const char* key, std::uint64_t count) const {
    const JsonMembers subtree(file_, json_);
    if (!subtree.contains(key)) subtree.fail(key, "is missing");
    return bits_of(subtree.members(key), count);
  }

  Bits bits_of(const JsonMembers& availability, std::uint64_t count) const {
    if (const auto constant = availability.find<std::uint64_t>("constant")) return {*constant != 0, {}};
    const char* key = "bitstream";
    if (!availability.has(key)) key = "bufferView";  // the extension's earlier name
    Bits out{false, view_bytes(availability, key, availability.get<std::uint64_t>(key, "a bitstream or a constant"))};
    if (out.bytes.size() < (count + 7) / 8)
      availability.fail(key, std::to_string(count) + " bits in " + std::to_string(out.bytes.size()) + " bytes");
    return out;
  }

  /// Returns the bytes of view `index`, which the member `key` of `availability` states.
  std::vector<std::uint8_t> view_bytes(const JsonMembers& availability, const char* key, std::uint64_t index) const {
    const JsonMembers subtree(file_, json_);
    const Json& views = subtree.array("bufferViews");
    if (index >= views.size()) availability.fail(key, std::to_string(index) + " is beyond the bufferViews");
    const JsonMembers view = subtree.element("bufferViews", views, index);
    const std::uint64_t offset = view.find<std::uint64_t>("byteOffset").value_or(0);
    const std::uint64_t length = view.find<std::uint64_t>("byteLength").value_or(0);
    std::vector<std::uint8_t> external;
    const std::span<const std::uint8_t> buffer = buffer_bytes(view.find<std::uint64_t>("buffer").value_or(0), external);
    if (offset > buffer.size() || length > buffer.size() - offset)
      view.fail("byteLength", "exceeds a buffer of " + std::to_string(buffer.size()) + " bytes");
    const auto bytes = buffer.subspan(offset, length);
    return {bytes.begin(), bytes.end()};
  }

  std::span<const std::uint8_t> buffer_bytes(std::uint64_t index, std::vector<std::uint8_t>& external) const {
    const JsonMembers subtree(file_, json_);
    const Json& buffers = subtree.array("buffers");
    if (index >= buffers.size())
      subtree.fail("buffers[" + std::to_string(index) + "]", "is beyond the list of buffers");
    const JsonMembers buffer = subtree.element("buffers", buffers, index);
    const auto uri = buffer.find<std::string>("uri");
    if (!uri) return binary_;
    external = files_.read_referenced(resolve_uri(files_.root(), file_, buffer.path_of("uri"), *uri));
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

std::uint64_t SubtreeAvailability::contents_below(const ImplicitTiling& tiling, const TileCoordinates& local) const {
  std::uint64_t contents = 0;
  for (std::size_t i = 0; i < contents_.size(); ++i) contents += content(i, tiling.index_in_subtree(local)) ? 1 : 0;
  for (int child = 0; child < tiling.children(); ++child) {
    const TileCoordinates next = local.child(child);
    if (next.level == tiling.subtree_levels)
      contents += child_subtree(tiling.index_in_level(next)) ? 1 : 0;
    else if (tile(tiling.index_in_subtree(next)))
      contents += contents_below(tiling, next);
  }
  return contents;
}

}  // namespace gigabake
