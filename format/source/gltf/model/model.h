/// Conversion of a checked glTF document from JSON to tinygltf's types.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace tinygltf {
class Model;
}

namespace gigabake {

/// Returns the members of a document that a bake uses. Keeps names of materials and nodes only. Omits buffers and
/// values of extensions that are not read. Keeps only the number of images, animations and skins. An index that is no
/// whole number, or is too large for an int, becomes the max int, which refers to nothing.
/// `gltf` must have passed check_gltf().
tinygltf::Model model_of(const nlohmann::json& gltf);

}  // namespace gigabake
