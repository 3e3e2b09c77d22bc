#include "format/source/gltf/model/extension_values.h"

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>

namespace gigabake {
namespace {

using tinygltf::Value;

/// Returns whether members of the extension are read.
bool has_read_members(const std::string& extension) {
  static const std::set<std::string> known{"EXT_instance_features",
                                           "EXT_mesh_features",
                                           "EXT_mesh_gpu_instancing",
                                           "EXT_texture_webp",
                                           "KHR_draco_mesh_compression",
                                           "KHR_materials_emissive_strength",
                                           "KHR_materials_pbrSpecularGlossiness",
                                           "KHR_node_visibility",
                                           "KHR_techniques_webgl",
                                           "KHR_texture_transform"};
  return known.contains(extension);
}

/// Returns whether the extension has lists of ids.
bool has_ids(const std::string& extension) {
  return extension == "EXT_mesh_features" || extension == "EXT_instance_features";
}

enum class EmptyValues : std::uint8_t { omitted, kept };

Value converted(const Json& json, EmptyValues empty);

Value object_of(const Json& json, EmptyValues empty) {
  const bool keeps = empty == EmptyValues::kept;
  Value::Object members;
  for (const auto& [key, member] : json.items())
    if (Value value = converted(member, empty); keeps || value.Type() != tinygltf::NULL_TYPE)
      members.emplace(key, std::move(value));
  return members.empty() && !keeps ? Value() : Value(std::move(members));
}

Value array_of(const Json& json, EmptyValues empty) {
  const bool keeps = empty == EmptyValues::kept;
  Value::Array items;
  for (const Json& item : json)
    if (Value value = converted(item, empty); keeps || value.Type() != tinygltf::NULL_TYPE)
      items.push_back(std::move(value));
  return items.empty() && !keeps ? Value() : Value(std::move(items));
}

Value number_of(const Json& json) {
  using Limits = std::numeric_limits<int>;
  const auto number = json.get<double>();
  const bool is_int = json.is_number_integer() && number >= Limits::min() && number <= Limits::max();
  return is_int ? Value(json.get<int>()) : Value(number);
}

Value converted(const Json& json, EmptyValues empty) {
  if (json.is_object()) return object_of(json, empty);
  if (json.is_array()) return array_of(json, empty);
  if (json.is_string()) return Value(json.get<std::string>());
  if (json.is_boolean()) return Value(json.get<bool>());
  return json.is_number() ? number_of(json) : Value();
}

}  // namespace

tinygltf::Value value_of(const Json& json) { return converted(json, EmptyValues::omitted); }

tinygltf::ExtensionMap extensions_of(const Json& object) {
  tinygltf::ExtensionMap out;
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return out;
  for (const auto& [name, json] : extensions->items()) {
    if (!json.is_object()) continue;
    const EmptyValues empty = has_ids(name) ? EmptyValues::kept : EmptyValues::omitted;
    Value value = has_read_members(name) ? converted(json, empty) : Value();
    out[name] = value.IsObject() ? std::move(value) : Value(Value::Object());
  }
  return out;
}

}  // namespace gigabake
