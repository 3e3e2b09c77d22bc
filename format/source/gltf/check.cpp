#include "format/source/gltf/check.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/source/content/data_uri.h"
#include "format/source/gltf/packed_views.h"
#include "format/source/gltf/version.h"
#include "format/source/image/codecs.h"

namespace gigabake {
namespace {

constexpr std::uint64_t max_accessor_items = std::uint64_t(1) << 31;
/// Max items of an accessor without a buffer view, which are zeros. A small file can declare any number of them.
constexpr std::uint64_t max_unbacked_items = std::uint64_t(1) << 24;

std::string item(const char* list, std::size_t i) { return std::string(list) + "[" + std::to_string(i) + "]"; }

class Checker {
 public:
  Checker(const SourceFiles& files, const std::filesystem::path& file, const Json& gltf, std::uint64_t bin_bytes)
      : files_(files), file_(file), gltf_(gltf), bin_bytes_(bin_bytes) {}

  void check() const {
    check_asset();
    for_each("buffers", [&](const Json& b, const std::string& where, std::size_t i) { check_buffer(b, where, i); });
    for_each("bufferViews", [&](const Json& v, const std::string& where, std::size_t) { check_view(v, where); });
    for_each("accessors", [&](const Json& a, const std::string& where, std::size_t) { check_accessor(a, where); });
    for_each("images", [&](const Json& i, const std::string& where, std::size_t) { check_image(i, where); });
    // Indices in textures and samplers are not checked. A wrong index costs one image, see model.cpp and
    // texture_info.cpp.
    for_each("textures", [](const Json&, const std::string&, std::size_t) {});
    for_each("samplers", [](const Json&, const std::string&, std::size_t) {});
    for_each("materials", [&](const Json& m, const std::string& where, std::size_t) { check_material(m, where); });
    for_each("meshes", [&](const Json& m, const std::string& where, std::size_t) { check_mesh(m, where); });
    for_each("nodes", [&](const Json& n, const std::string& where, std::size_t) { check_node(n, where); });
    for_each("scenes", [&](const Json& s, const std::string& where, std::size_t) {
      check_references(s, where, "nodes", "nodes");
    });
    check_reference(gltf_, "", "scene", "scenes");
    check_forest();
    check_unused_states(file_, gltf_);
  }

 private:
  [[noreturn]] void fail(const std::string& where, const std::string& message) const {
    throw InputError(file_, where, message);
  }

  template <class Visit>
  void for_each(const char* list, const Visit& visit) const {
    const Json& items = get_array(file_, gltf_, "", list);
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (!items[i].is_object()) fail(item(list, i), "expected an object");
      visit(items[i], item(list, i), i);
    }
  }

  std::size_t size(const char* list) const { return get_array(file_, gltf_, "", list).size(); }

  std::optional<std::uint64_t> check_reference(const Json& object, const std::string& where, const char* key,
                                               const char* list) const {
    const auto index = get_index(file_, object, where, key);
    if (index && *index >= size(list))
      fail(where.empty() ? key : where + "." + key,
           std::to_string(*index) + " is beyond the " + std::to_string(size(list)) + " " + list);
    return index;
  }

  void check_references(const Json& object, const std::string& where, const char* key, const char* list) const {
    const Json& items = get_array(file_, object, where, key);
    for (std::size_t i = 0; i < items.size(); ++i)
      if (!items[i].is_number_unsigned() || items[i].get<std::uint64_t>() >= size(list))
        fail(where + "." + item(key, i),
             std::string("expected the index of one of the ") + std::to_string(size(list)) + " " + list);
  }

  void check_asset() const {
    expect_gltf_2(file_, gltf_);
    static const std::set<std::string> known{"KHR_texture_transform",
                                             "KHR_materials_unlit",
                                             "KHR_materials_pbrSpecularGlossiness",
                                             "KHR_mesh_quantization",
                                             "EXT_meshopt_compression",
                                             "KHR_draco_mesh_compression",
                                             "EXT_texture_webp",
                                             "CESIUM_RTC",
                                             "EXT_mesh_gpu_instancing",
                                             "KHR_node_visibility",
                                             "KHR_lights_punctual",
                                             "KHR_materials_clearcoat",
                                             "KHR_materials_emissive_strength",
                                             "KHR_materials_ior",
                                             "KHR_materials_iridescence",
                                             "KHR_materials_sheen",
                                             "KHR_materials_specular",
                                             "KHR_materials_anisotropy",
                                             "KHR_materials_variants",
                                             "EXT_mesh_features",
                                             "EXT_structural_metadata",
                                             "EXT_instance_features",
                                             "CESIUM_primitive_outline",
                                             "KHR_xmp_json_ld"};
    for (const Json& e : get_array(file_, gltf_, "", "extensionsRequired")) {
      const std::string name = e.is_string() ? e.get<std::string>() : "(not a string)";
      if (const auto why = missing_codec(name)) fail("extensionsRequired", *why);
      if (!known.contains(name)) fail("extensionsRequired", "the extension " + in_quotes(name) + " is not supported");
    }
  }

  void check_buffer(const Json& buffer, const std::string& where, std::size_t index) const {
    const auto bytes = get_index(file_, buffer, where, "byteLength");
    if (!bytes || *bytes == 0) fail(where + ".byteLength", "expected at least 1");
    const auto uri = get_text(file_, buffer, where, "uri");
    if (is_absent_fallback(file_, buffer, index, bin_bytes_ != 0)) return;
    std::uint64_t there = 0;
    if (!uri) {
      if (index != 0 || bin_bytes_ == 0)
        fail(where + ".uri", "is missing, and there is no binary chunk for this buffer");
      there = bin_bytes_;
    } else if (is_data_uri(*uri)) {
      there = uri->size();  // an upper bound; unpacking finds missing bytes
    } else {
      there = size_of_external(where, *uri, *bytes);
    }
    if (*bytes > there)
      fail(where + ".byteLength", "states " + std::to_string(*bytes) + " bytes, there are " + std::to_string(there));
  }

  /// Returns the stored size of an external file, or its unpacked size if fewer than `wanted` bytes are stored.
  std::uint64_t size_of_external(const std::string& where, const std::string& uri, std::uint64_t wanted) const {
    const std::filesystem::path path = resolve_uri(files_.root(), file_, where + ".uri", uri);
    if (!files_.has(path)) fail(where + ".uri", "no such file: " + in_quotes(uri));
    const std::uint64_t stored = files_.size_of(path);
    return stored >= wanted ? stored : files_.read_referenced(path).size();
  }

  void check_view(const Json& view, const std::string& where) const {
    const auto buffer = check_reference(view, where, "buffer", "buffers");
    if (!buffer) fail(where + ".buffer", "is missing");
    const std::uint64_t whole = get_index(file_, gltf_["buffers"][*buffer], "buffers", "byteLength").value_or(0);
    const std::uint64_t offset = get_index(file_, view, where, "byteOffset").value_or(0);
    const auto bytes = get_index(file_, view, where, "byteLength");
    if (!bytes || *bytes == 0) fail(where + ".byteLength", "expected at least 1");
    if (offset > whole || *bytes > whole - offset)
      fail(where, "bytes " + std::to_string(offset) + " to " + std::to_string(offset + *bytes) +
                      " exceed a buffer of " + std::to_string(whole) + " bytes");
    const std::uint64_t stride = get_index(file_, view, where, "byteStride").value_or(0);
    if (stride > 1024) fail(where + ".byteStride", "expected at most 252");
    const bool is_packed = is_absent_fallback(file_, gltf_["buffers"][*buffer], *buffer, bin_bytes_ != 0);
    if (!is_packed && (stride > 252 || stride % 4 != 0))  // packed_views.cpp checks the strides of packed views
      fail("", "Invalid `byteStride' value. `byteStride' must be the multiple of 4 : " + std::to_string(stride));
    get_index(file_, view, where, "target");
  }

  static std::uint64_t component_bytes(std::uint64_t type) {
    static const std::map<std::uint64_t, std::uint64_t> bytes{{5120, 1}, {5121, 1}, {5122, 2},
                                                              {5123, 2}, {5125, 4}, {5126, 4}};
    const auto it = bytes.find(type);
    return it == bytes.end() ? 0 : it->second;
  }

  /// Distance of items: the stride of the view, or, in a sparse accessor, always the size of an item.
  enum class Spacing { of_view, none };

  /// Checks that `count` items of `item_bytes` bytes each are within the view.
  void check_range(const Json& user, const std::string& where, std::uint64_t count, std::uint64_t item_bytes,
                   Spacing spacing) const {
    const auto index = check_reference(user, where, "bufferView", "bufferViews");
    if (!index) fail(where + ".bufferView", "is missing");
    const Json& view = gltf_["bufferViews"][*index];
    const std::uint64_t whole = get_index(file_, view, "bufferViews", "byteLength").value_or(0);
    const std::uint64_t stride = get_index(file_, view, "bufferViews", "byteStride").value_or(0);
    const std::uint64_t step = stride != 0 && spacing == Spacing::of_view ? stride : item_bytes;
    const std::uint64_t offset = get_index(file_, user, where, "byteOffset").value_or(0);
    if (offset > whole || item_bytes > whole - offset || (count - 1) > (whole - offset - item_bytes) / step)
      fail(where, pluralize(count, "item") + " from byte " + std::to_string(offset) + " exceed a buffer view of " +
                      std::to_string(whole) + " bytes");
  }

  void check_accessor(const Json& a, const std::string& where) const {
    static const std::map<std::string, std::uint64_t> components{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                                 {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    const std::uint64_t bytes = component_bytes(get_index(file_, a, where, "componentType").value_or(0));
    if (bytes == 0) fail(where + ".componentType", "expected 5120 to 5123, 5125 or 5126");
    const auto type = components.find(get_text(file_, a, where, "type").value_or(""));
    if (type == components.end()) fail(where + ".type", "expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
    const std::uint64_t count = get_index(file_, a, where, "count").value_or(0);
    if (count == 0 || count > max_accessor_items) fail(where + ".count", "expected 1 to 2^31");
    const std::uint64_t item_bytes = type->second * bytes;
    if (a.contains("bufferView"))
      check_range(a, where, count, item_bytes, Spacing::of_view);
    else if (count > max_unbacked_items)
      fail(where + ".count", pluralize(count, "item") + " without a buffer view");
    if (a.contains("sparse")) check_sparse(a["sparse"], where + ".sparse", count, item_bytes);
  }

  void check_sparse(const Json& sparse, const std::string& where, std::uint64_t whole, std::uint64_t item_bytes) const {
    const std::uint64_t count = get_index(file_, sparse, where, "count").value_or(0);
    if (count == 0 || count > whole) fail(where + ".count", "expected 1 to the accessor's " + std::to_string(whole));
    const Json& indices = get_object(file_, sparse, where, "indices");
    const std::uint64_t type = get_index(file_, indices, where + ".indices", "componentType").value_or(0);
    if (type != 5121 && type != 5123 && type != 5125)
      fail(where + ".indices.componentType", "expected 5121, 5123 or 5125");
    check_range(indices, where + ".indices", count, component_bytes(type), Spacing::none);
    check_range(get_object(file_, sparse, where, "values"), where + ".values", count, item_bytes, Spacing::none);
  }

  void check_image(const Json& image, const std::string& where) const {
    check_reference(image, where, "bufferView", "bufferViews");
    get_text(file_, image, where, "mimeType");
    get_text(file_, image, where, "uri");
  }

  void check_texture_use(const Json& owner, const std::string& where, const char* key) const {
    get_index(file_, get_object(file_, owner, where, key), where + "." + key, "texCoord");
  }

  void check_material(const Json& m, const std::string& where) const {
    const Json& pbr = get_object(file_, m, where, "pbrMetallicRoughness");
    check_texture_use(pbr, where + ".pbrMetallicRoughness", "baseColorTexture");
    check_texture_use(pbr, where + ".pbrMetallicRoughness", "metallicRoughnessTexture");
    get_numbers(file_, pbr, where + ".pbrMetallicRoughness", "baseColorFactor", 4);
    for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"}) check_texture_use(m, where, key);
    const Json& extensions = get_object(file_, m, where, "extensions");
    const std::string gloss = where + ".extensions.KHR_materials_pbrSpecularGlossiness";
    const Json& specular = get_object(file_, extensions, where + ".extensions", "KHR_materials_pbrSpecularGlossiness");
    check_texture_use(specular, gloss, "diffuseTexture");
    get_numbers(file_, specular, gloss, "diffuseFactor", 4);
    check_emission(m, where);
    get_number(file_, m, where, "alphaCutoff");
    const std::string mode = get_text(file_, m, where, "alphaMode").value_or("OPAQUE");
    if (!value_named<AlphaMode>(mode))
      fail(where + ".alphaMode", "expected one of " + all_names<AlphaMode>() + ", got " + in_quotes(mode));
  }

  /// Refuses a list of numbers whose length is not 3. Any other wrong value counts as no emission.
  void check_emission(const Json& m, const std::string& where) const {
    const auto factor = m.find("emissiveFactor");
    if (factor == m.end() || !factor->is_array() || factor->size() == 3) return;
    if (std::all_of(factor->begin(), factor->end(), [](const Json& v) { return v.is_number(); }))
      fail(where + ".emissiveFactor", "expected 3 numbers");
  }

  void check_mesh(const Json& mesh, const std::string& where) const {
    const Json& primitives = get_array(file_, mesh, where, "primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const std::string at = where + "." + item("primitives", i);
      const auto indices = check_reference(primitives[i], at, "indices", "accessors");
      check_reference(primitives[i], at, "material", "materials");
      if (get_index(file_, primitives[i], at, "mode").value_or(4) > 6) fail(at + ".mode", "expected 0 to 6");
      const Json& attributes = get_object(file_, primitives[i], at, "attributes");
      for (const auto& [name, index] : attributes.items())
        check_reference(attributes, at + ".attributes", name.c_str(), "accessors");
      const Json& extensions = get_object(file_, primitives[i], at, "extensions");
      const Json& draco = get_object(file_, extensions, at, "KHR_draco_mesh_compression");
      check_reference(draco, at + ".extensions", "bufferView", "bufferViews");
      if (indices && draco.empty() && primitives[i].contains("attributes")) check_backed(*indices);
    }
  }

  /// Refuses indices whose accessor has no buffer view.
  void check_backed(std::uint64_t accessor) const {
    if (!gltf_["accessors"][accessor].contains("bufferView"))
      fail("", item("accessor", accessor) + " invalid bufferView");
  }

  void check_node(const Json& node, const std::string& where) const {
    check_reference(node, where, "mesh", "meshes");
    check_references(node, where, "children", "nodes");
    get_numbers(file_, node, where, "matrix", 16);
    get_numbers(file_, node, where, "translation", 3);
    get_numbers(file_, node, where, "rotation", 4);
    get_numbers(file_, node, where, "scale", 3);
    const Json& extensions = get_object(file_, node, where, "extensions");
    const Json& instancing = get_object(file_, extensions, where, "EXT_mesh_gpu_instancing");
    const Json& attributes = get_object(file_, instancing, where, "attributes");
    for (const auto& [name, index] : attributes.items())
      check_reference(attributes, where + ".EXT_mesh_gpu_instancing", name.c_str(), "accessors");
  }

  /// Checks that no node has two parents and that there is no cycle.
  void check_forest() const {
    const Json& nodes = get_array(file_, gltf_, "", "nodes");
    constexpr std::size_t none = ~std::size_t(0);
    std::vector<std::size_t> parent(nodes.size(), none);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (const Json& child : get_array(file_, nodes[i], item("nodes", i), "children")) {
        std::size_t& p = parent[child.get<std::size_t>()];
        if (p != none) fail(item("nodes", child.get<std::size_t>()), "is the child of two nodes");
        p = i;
      }
    // Each node has at most one parent, so no root reaches the nodes of a cycle.
    std::vector<std::size_t> reached;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (parent[i] == none) reached.push_back(i);
    for (std::size_t at = 0; at < reached.size(); ++at)
      for (const Json& child : get_array(file_, nodes[reached[at]], "nodes", "children"))
        reached.push_back(child.get<std::size_t>());
    if (reached.size() != nodes.size()) fail("nodes", "the hierarchy has a cycle");
  }

  const SourceFiles& files_;
  const std::filesystem::path& file_;
  const Json& gltf_;
  std::uint64_t bin_bytes_;
};

}  // namespace

void check_gltf(const SourceFiles& files, const std::filesystem::path& file, const Json& gltf,
                std::uint64_t bin_bytes) {
  Checker(files, file, gltf, bin_bytes).check();
}

}  // namespace gigabake
