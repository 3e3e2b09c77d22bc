#include "format/source/gltf/version.h"

#include "core/base/error.h"

namespace gigabake {
namespace {

/// Returns whether lists are objects of named items, as in glTF 1.0, which did not require a version.
bool is_of_named_items(const Json& gltf) {
  for (const char* list : {"meshes", "accessors", "buffers", "nodes"})
    if (gltf.contains(list) && gltf[list].is_object()) return true;
  return false;
}

}  // namespace

void refuse_gltf_1(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  const bool is_tile = extension == ".b3dm" || extension == ".i3dm" || extension == ".cmpt";
  throw InputError(file, "",
                   is_tile
                       ? "holds glTF 1.0, expected 2.0; convert it: npx 3d-tiles-tools upgrade -i TILESET.json -o NEW"
                       : "is glTF 1.0, expected 2.0; convert it: npx gltf-pipeline -i OLD -o NEW.glb");
}

void expect_gltf_2(const std::filesystem::path& file, const Json& gltf) {
  if (!gltf.is_object()) throw InputError(file, "", "expected a glTF document, a JSON object");
  const std::string version = get_text(file, get_object(file, gltf, "", "asset"), "asset", "version").value_or("");
  if (version.starts_with("1.") || version.starts_with("0.") || (version.empty() && is_of_named_items(gltf)))
    refuse_gltf_1(file);
  if (!version.starts_with("2."))
    throw InputError(file, "asset.version", "expected glTF 2.0, got " + in_quotes(version));
}

}  // namespace gigabake
