#include "format/source/gltf/bounds.h"

#include <cstring>
#include <utility>

#include "core/base/error.h"
#include "core/math/transform.h"
#include "format/source/content/content_magic.h"
#include "format/source/content/content_pieces.h"
#include "format/source/gltf/nodes.h"
#include "format/source/tiles/b3dm_layout.h"
#include "format/source/tiles/feature_table.h"

namespace gigabake {
namespace {

using Vector = std::array<double, 3>;
using Map = Affine<Gltf, Local>;

/// JSON of a document, and the RTC_CENTER of its container.
struct GltfHead {
  Json json;
  Vector rtc_center{};
};

template <std::size_t N>
std::array<std::uint32_t, N> words_at(ContentPieces& pieces, std::uint64_t offset) {
  std::array<std::uint32_t, N> words{};
  const std::vector<std::uint8_t> bytes = pieces.read(offset, sizeof words);
  if (!bytes.empty()) std::memcpy(words.data(), bytes.data(), bytes.size());  // memcpy takes no null pointer
  return words;
}

GltfHead head_of(const TileRef& tile, const SourceFiles& files) {
  constexpr std::uint64_t whole = std::uint64_t(1) << 32;
  constexpr std::uint32_t glb_head_bytes = 20;
  ContentPieces pieces(tile, files);
  GltfHead out;
  std::uint64_t at = 0;
  if (content_magic(pieces.read(0, 4)) == ContentMagic::b3dm) {
    const B3dmLayout layout = b3dm_layout(words_at<4>(pieces, 12));
    const auto& bytes = layout.table_bytes;
    const std::vector<std::uint8_t> json = pieces.read(layout.header_bytes, bytes[0]),
                                    binary = pieces.read(std::uint64_t(layout.header_bytes) + bytes[0], bytes[1]);
    out.rtc_center = FeatureTable(tile.path, json, binary).vector("RTC_CENTER").value_or(Vector{});
    at = layout.header_bytes;
    for (const std::uint32_t part : bytes) at += part;
  }
  const bool is_binary = content_magic(pieces.read(at, 4)) == ContentMagic::glb;
  const std::uint64_t json_bytes = is_binary ? words_at<4>(pieces, at)[3] : whole;
  out.json = parse_json(tile.path, pieces.read(at + (is_binary ? glb_head_bytes : 0), json_bytes));
  return out;
}

/// The computation of the bounds of a glTF scene from its nodes and accessors.
class Bounds {
 public:
  Bounds(const TileRef& tile, const GltfHead& head) : file_(tile.path), json_(head.json) {
    const Json& rtc = get_object(file_, get_object(file_, json_, "", "extensions"), "extensions", "CESIUM_RTC");
    const auto centre = get_numbers(file_, rtc, "extensions.CESIUM_RTC", "center", 3).value_or(std::vector<double>(3));
    const Vector& rtc_center = head.rtc_center;
    world_from_gltf_ =
        translation<World, World>(rtc_center[0] + centre[0], rtc_center[1] + centre[1], rtc_center[2] + centre[2]) *
        z_up_from<World, Gltf>(tile.gltf_up);
  }

  WorldBox of_scene() {
    for (const std::size_t n : roots()) pending_.push_back({n, Map()});
    for (std::size_t visits = 0; !pending_.empty(); ++visits) {
      if (visits > list("nodes").size()) throw InputError(file_, "nodes", "the hierarchy is not a tree");
      const auto [node, parent] = pending_.back();
      pending_.pop_back();
      visit(node, parent);
    }
    return box_;
  }

 private:
  const Json& list(const char* key) const { return get_array(file_, json_, "", key); }

  const Json& item(const char* key, std::size_t index) const {
    const Json& items = list(key);
    if (index >= items.size() || !items[index].is_object())
      throw InputError(file_, key, "expected an object at " + std::to_string(index));
    return items[index];
  }

  std::vector<std::size_t> indices(const Json& object, const char* where, const char* key) const {
    std::vector<std::size_t> out;
    for (const Json& v : get_array(file_, object, where, key)) {
      if (!v.is_number_unsigned()) throw InputError(file_, std::string(where) + "." + key, "expected indices");
      out.push_back(v.get<std::size_t>());
    }
    return out;
  }

  std::vector<std::size_t> roots() const {
    if (!list("scenes").empty())
      return indices(item("scenes", get_index(file_, json_, "", "scene").value_or(0)), "scenes", "nodes");
    std::vector<bool> is_child(list("nodes").size(), false);
    for (std::size_t n = 0; n < is_child.size(); ++n)
      for (const std::size_t child : indices(item("nodes", n), "nodes", "children"))
        if (child < is_child.size()) is_child[child] = true;
    std::vector<std::size_t> out;
    for (std::size_t n = 0; n < is_child.size(); ++n)
      if (!is_child[n]) out.push_back(n);
    return out;
  }

  template <std::size_t N>
  std::array<double, N> numbers_or(const Json& node, const char* key, std::array<double, N> otherwise) const {
    if (const auto v = get_numbers(file_, node, "nodes", key, N)) std::copy(v->begin(), v->end(), otherwise.begin());
    return otherwise;
  }

  Affine<Local, Local> map_of(const Json& node) const {
    if (const auto m = get_numbers(file_, node, "nodes", "matrix", 16)) return affine_from_columns<Local, Local>(*m);
    return affine_from_trs<Local, Local>(numbers_or<3>(node, "translation", {0, 0, 0}),
                                         numbers_or<4>(node, "rotation", {0, 0, 0, 1}),
                                         numbers_or<3>(node, "scale", {1, 1, 1}));
  }

  void visit(std::size_t index, const Map& parent) {
    const Json& node = item("nodes", index);
    const Json& visibility =
        get_object(file_, get_object(file_, node, "nodes", "extensions"), "extensions", "KHR_node_visibility");
    if (visibility.value("visible", Json(true)) == Json(false)) return;
    const Map map = parent * map_of(node);
    for (const std::size_t child : indices(node, "nodes", "children")) pending_.push_back({child, map});
    const auto mesh = get_index(file_, node, "nodes", "mesh");
    if (!mesh) return;
    for (const Json& primitive : get_array(file_, item("meshes", *mesh), "meshes", "primitives")) {
      const Json& attributes = get_object(file_, primitive, "primitives", "attributes");
      if (const auto position = get_index(file_, attributes, "attributes", "POSITION"))
        add(item("accessors", *position), world_from_gltf_ * map);
    }
  }

  /// Returns the divisor that maps an integer of the accessor to a coordinate.
  double divisor_of(const Json& accessor) const {
    if (!accessor.value("normalized", Json(false)).is_boolean() || !accessor.value("normalized", false)) return 1;
    switch (get_index(file_, accessor, "accessors", "componentType").value_or(0)) {
      case 5120:
        return 127;
      case 5121:
        return 255;
      case 5122:
        return 32767;
      case 5123:
        return 65535;
      default:
        return 1;
    }
  }

  void add(const Json& accessor, const Affine<World, Local>& world_from_local) {
    const double by = divisor_of(accessor);
    const std::vector<double> zeros(3);
    const auto low = get_numbers(file_, accessor, "accessors", "min", 3).value_or(zeros),
               high = get_numbers(file_, accessor, "accessors", "max", 3).value_or(zeros);
    for (unsigned corner = 0; corner < 8; ++corner) {
      const auto at = [&](unsigned axis) { return (corner >> axis & 1u ? high[axis] : low[axis]) / by; };
      box_.add(world_from_local({at(0), at(1), at(2)}));
    }
  }

  const std::filesystem::path& file_;
  const Json& json_;
  Affine<World, Gltf> world_from_gltf_;
  std::vector<std::pair<std::size_t, Map>> pending_;
  WorldBox box_;
};

}  // namespace

WorldBox gltf_bounds(const TileRef& tile, const SourceFiles& files) {
  const GltfHead head = head_of(tile, files);
  if (!head.json.is_object()) throw InputError(tile.path, "", "expected a glTF document, a JSON object");
  return Bounds(tile, head).of_scene();
}

}  // namespace gigabake
