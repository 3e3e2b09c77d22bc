#include "format/source/gltf/model/model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <tiny_gltf.h>
#include <utility>
#include <vector>

#include "format/source/gltf/model/extension_values.h"
#include "format/source/json/json_parse.h"

namespace gigabake {
namespace {

constexpr int no_index = std::numeric_limits<int>::max();  ///< replaces an index that refers to nothing

/// Returns a member; null if there is none.
const Json& member(const Json& object, const char* key) {
  static const Json none;
  const auto at = object.find(key);
  return at == object.end() ? none : *at;
}

int to_int(std::uint64_t value) { return int(std::min<std::uint64_t>(value, no_index)); }

/// Returns an index, or the number of a constant, that check_gltf() has checked.
int index_of(const Json& object, const char* key, int otherwise = -1) {
  const Json& value = member(object, key);
  return value.is_number_unsigned() ? to_int(value.get<std::uint64_t>()) : otherwise;
}

std::uint64_t size_of(const Json& object, const char* key) {
  const Json& value = member(object, key);
  return value.is_number_unsigned() ? value.get<std::uint64_t>() : 0;
}

/// Returns an index that check_gltf() does not check, because a wrong index costs one image. 3.0 counts as 3. Any other
/// value that is not an index becomes no_index.
int unchecked_index_of(const Json& object, const char* key, int otherwise) {
  const auto at = object.find(key);
  if (at == object.end()) return otherwise;
  const double value = at->is_number() ? at->get<double>() : -1;
  const bool is_index = value >= 0 && value < no_index && value == std::floor(value);
  return is_index ? int(value) : no_index;
}

std::string text_of(const Json& object, const char* key, const char* otherwise = "") {
  const Json& value = member(object, key);
  return value.is_string() ? value.get<std::string>() : otherwise;
}

bool is_list_of_numbers(const Json& value) {
  return value.is_array() && std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_number(); });
}

/// Returns a list of numbers; empty if the member is no such list.
std::vector<double> numbers_of(const Json& object, const char* key) {
  const Json& value = member(object, key);
  return is_list_of_numbers(value) ? value.get<std::vector<double>>() : std::vector<double>();
}

std::vector<int> indices_of(const Json& object, const char* key) {
  std::vector<int> out;
  const Json& list = member(object, key);
  out.reserve(list.size());
  for (const Json& index : list) out.push_back(to_int(index.get<std::uint64_t>()));
  return out;
}

/// Returns the items of a list of objects, each converted by `read`.
template <class Read>
auto items_of(const Json& object, const char* key, const Read& read) {
  std::vector<decltype(read(object))> out;
  const Json& list = member(object, key);
  out.reserve(list.size());
  for (const Json& item : list) out.push_back(read(item));
  return out;
}

tinygltf::BufferView view_of(const Json& json) {
  tinygltf::BufferView out;
  out.buffer = index_of(json, "buffer");
  out.byteOffset = size_of(json, "byteOffset");
  out.byteLength = size_of(json, "byteLength");
  out.byteStride = size_of(json, "byteStride");
  return out;
}

int accessor_type_of(const Json& json) {
  static const std::map<std::string, int> types{{"SCALAR", TINYGLTF_TYPE_SCALAR}, {"VEC2", TINYGLTF_TYPE_VEC2},
                                                {"VEC3", TINYGLTF_TYPE_VEC3},     {"VEC4", TINYGLTF_TYPE_VEC4},
                                                {"MAT2", TINYGLTF_TYPE_MAT2},     {"MAT3", TINYGLTF_TYPE_MAT3},
                                                {"MAT4", TINYGLTF_TYPE_MAT4}};
  return types.at(text_of(json, "type"));
}

void read_sparse(const Json& json, tinygltf::Accessor& out) {
  const Json &indices = member(json, "indices"), &values = member(json, "values");
  out.sparse.isSparse = true;
  out.sparse.count = index_of(json, "count");
  out.sparse.indices.bufferView = index_of(indices, "bufferView");
  out.sparse.indices.byteOffset = index_of(indices, "byteOffset", 0);
  out.sparse.indices.componentType = index_of(indices, "componentType");
  out.sparse.values.bufferView = index_of(values, "bufferView");
  out.sparse.values.byteOffset = index_of(values, "byteOffset", 0);
}

tinygltf::Accessor accessor_of(const Json& json) {
  tinygltf::Accessor out;
  out.bufferView = index_of(json, "bufferView");
  out.byteOffset = size_of(json, "byteOffset");
  out.normalized = member(json, "normalized") == Json(true);
  out.componentType = index_of(json, "componentType");
  out.count = size_of(json, "count");
  out.type = accessor_type_of(json);
  if (json.contains("sparse")) read_sparse(json["sparse"], out);
  return out;
}

tinygltf::Primitive primitive_of(const Json& json) {
  tinygltf::Primitive out;
  out.material = index_of(json, "material");
  out.mode = index_of(json, "mode", TINYGLTF_MODE_TRIANGLES);
  out.indices = index_of(json, "indices");
  for (const auto& [name, index] : member(json, "attributes").items())
    if (index.is_number_unsigned()) out.attributes.emplace(name, to_int(index.get<std::uint64_t>()));
  const Json& targets = member(json, "targets");
  if (targets.is_array())
    out.targets.resize(std::size_t(
        std::count_if(targets.begin(), targets.end(), [](const Json& target) { return target.is_object(); })));
  out.extensions = extensions_of(json);
  return out;
}

tinygltf::Mesh mesh_of(const Json& json) {
  tinygltf::Mesh out;
  out.primitives = items_of(json, "primitives", primitive_of);
  return out;
}

tinygltf::Node node_of(const Json& json) {
  tinygltf::Node out;
  out.name = text_of(json, "name");
  out.mesh = index_of(json, "mesh");
  out.children = indices_of(json, "children");
  out.matrix = numbers_of(json, "matrix");
  if (out.matrix.empty()) {
    out.translation = numbers_of(json, "translation");
    out.rotation = numbers_of(json, "rotation");
    out.scale = numbers_of(json, "scale");
  }
  out.extensions = extensions_of(json);
  return out;
}

tinygltf::Scene scene_of(const Json& json) {
  tinygltf::Scene out;
  out.nodes = indices_of(json, "nodes");
  return out;
}

tinygltf::Texture texture_of(const Json& json) {
  tinygltf::Texture out;
  out.source = unchecked_index_of(json, "source", -1);
  out.sampler = unchecked_index_of(json, "sampler", -1);
  out.extensions = extensions_of(json);
  return out;
}

tinygltf::Sampler sampler_of(const Json& json) {
  tinygltf::Sampler out;
  out.magFilter = unchecked_index_of(json, "magFilter", out.magFilter);
  out.wrapS = unchecked_index_of(json, "wrapS", out.wrapS);
  out.wrapT = unchecked_index_of(json, "wrapT", out.wrapT);
  return out;
}

/// Reads a textureInfo of a material. A textureInfo without an index gets no_index.
template <class Info>
void read_texture_info(const Json& owner, const char* key, Info& out) {
  const Json& json = member(owner, key);
  if (!json.is_object()) return;
  out.index = unchecked_index_of(json, "index", no_index);
  out.texCoord = index_of(json, "texCoord", 0);
  out.extensions = extensions_of(json);
}

/// Returns whether tinygltf's parser keeps the value of a material's member.
bool has_value(const Json& value) { return value.is_array() ? is_list_of_numbers(value) : !value.is_null(); }

void read_metallic_roughness(const Json& json, tinygltf::Material& out) {
  tinygltf::PbrMetallicRoughness& pbr = out.pbrMetallicRoughness;
  if (json.contains("baseColorFactor")) pbr.baseColorFactor = numbers_of(json, "baseColorFactor");
  read_texture_info(json, "baseColorTexture", pbr.baseColorTexture);
  read_texture_info(json, "metallicRoughnessTexture", pbr.metallicRoughnessTexture);
  for (const auto& [key, value] : json.items())
    if (has_value(value)) out.values.emplace(key, tinygltf::Parameter());
}

/// Sets the index of the texture of KHR_materials_pbrSpecularGlossiness by the rules of read_texture_info().
void fit_diffuse_texture(const Json& material, tinygltf::ExtensionMap& extensions) {
  constexpr const char* gloss_extension = "KHR_materials_pbrSpecularGlossiness";
  const Json& texture = member(member(member(material, "extensions"), gloss_extension), "diffuseTexture");
  if (!texture.is_object()) return;
  using tinygltf::Value;
  Value& out = extensions.at(gloss_extension).Get<Value::Object>()["diffuseTexture"];
  if (!out.IsObject()) out = Value(Value::Object());
  out.Get<Value::Object>()["index"] = Value(unchecked_index_of(texture, "index", no_index));
}

tinygltf::Material material_of(const Json& json) {
  tinygltf::Material out;
  out.name = text_of(json, "name");
  out.emissiveFactor = numbers_of(json, "emissiveFactor");
  if (out.emissiveFactor.empty()) out.emissiveFactor = {0, 0, 0};
  out.alphaMode = text_of(json, "alphaMode", "OPAQUE");
  const Json &cutoff = member(json, "alphaCutoff"), &pbr = member(json, "pbrMetallicRoughness");
  if (cutoff.is_number()) out.alphaCutoff = cutoff.get<double>();
  out.doubleSided = member(json, "doubleSided") == Json(true);
  if (pbr.is_object()) read_metallic_roughness(pbr, out);
  read_texture_info(json, "normalTexture", out.normalTexture);
  const Json& normal_scale = member(member(json, "normalTexture"), "scale");
  if (normal_scale.is_number()) out.normalTexture.scale = normal_scale.get<double>();
  read_texture_info(json, "occlusionTexture", out.occlusionTexture);
  read_texture_info(json, "emissiveTexture", out.emissiveTexture);
  out.extensions = extensions_of(json);
  fit_diffuse_texture(json, out.extensions);
  return out;
}

std::vector<std::string> extensions_used(const Json& gltf) {
  std::vector<std::string> out;
  const Json& list = member(gltf, "extensionsUsed");
  if (list.is_array())
    for (const Json& name : list) out.push_back(name.is_string() ? name.get<std::string>() : "");
  return out;
}

}  // namespace

tinygltf::Model model_of(const Json& gltf) {
  tinygltf::Model out;
  out.bufferViews = items_of(gltf, "bufferViews", view_of);
  out.accessors = items_of(gltf, "accessors", accessor_of);
  out.meshes = items_of(gltf, "meshes", mesh_of);
  out.nodes = items_of(gltf, "nodes", node_of);
  out.scenes = items_of(gltf, "scenes", scene_of);
  out.defaultScene = index_of(gltf, "scene");
  out.textures = items_of(gltf, "textures", texture_of);
  out.samplers = items_of(gltf, "samplers", sampler_of);
  out.materials = items_of(gltf, "materials", material_of);
  out.images.resize(member(gltf, "images").size());
  out.animations.resize(member(gltf, "animations").size());
  out.skins.resize(member(gltf, "skins").size());
  out.extensionsUsed = extensions_used(gltf);
  return out;
}

}  // namespace gigabake
