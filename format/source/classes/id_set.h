/// Sets of ids in glTF: the entries of `featureIds` in EXT_mesh_features and EXT_instance_features.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tiny_gltf.h>

namespace gigabake {

/// A function that throws the error of ids that cannot be used.
using RefuseIds = std::function<void(const std::string& message)>;

/// Returns a member that is a whole number of at least 0; nullopt if it is absent or has another value.
std::optional<double> whole_number_in(const tinygltf::Value& object, const char* key);

/// Returns set number `set` of an extension of a primitive or node.
/// Errors  The error of `refuse`: the extension or the set is missing.
const tinygltf::Value& id_set(const tinygltf::ExtensionMap& extensions, const std::string& extension, int set,
                              const RefuseIds& refuse);
/// Returns the name of the attribute with the ids of a set; nullopt if the ids are the numbers of the items.
/// Errors  The error of `refuse`: the attribute is not a number.
std::optional<std::string> id_attribute(const tinygltf::Value& set, const RefuseIds& refuse);
/// Returns the id that means no feature; −1 if there is none.
double null_id_of(const tinygltf::Value& set);

}  // namespace gigabake
