#include "format/source/invisible_material.h"

#include "core/base/error.h"
#include "format/source/content/content_container.h"
#include "format/source/gltf/load.h"
#include "format/source/gltf/material.h"
#include "format/source/mesh/obj_material.h"
#include "format/source/mesh/obj_read.h"
#include "format/source/source_files.h"
#include "format/source/source_warning.h"

namespace gigabake {
namespace {

bool is_invisible(const Material& m) {
  if (m.alpha_mode == AlphaMode::opaque) return false;
  return m.base_color[3] < min_visible_alpha || (m.alpha_mode == AlphaMode::mask && m.alpha_cutoff > 1);
}

std::optional<std::string> of_gltf(const TileRef& tile, const std::filesystem::path& root) {
  const GltfDocument document = load_gltf(tile, root, false);
  const auto& materials = document.model.materials;
  SourceWarnings unused;
  for (std::size_t i = 0; i < materials.size(); ++i)
    if (is_invisible(source_material(tile.path, document.model, int(i), unused).material))
      return materials[i].name.empty() ? std::to_string(i) : in_quotes(materials[i].name);
  return std::nullopt;
}

std::optional<std::string> of_obj(const TileRef& tile, const SourceFiles& files) {
  for (const std::filesystem::path& file : obj_dependencies(tile, files)) {
    if (file.extension() != ".mtl" || !files.has(file)) continue;
    SourceWarnings unused;
    for (const auto& [name, material] : read_mtl(file, files.read(file), unused))
      if (material.base_color[3] < min_visible_alpha) return in_quotes(name);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> invisible_material(const TileRef& tile, const std::filesystem::path& root) {
  switch (tile.kind) {
    case ContentKind::glb:
    case ContentKind::gltf:
    case ContentKind::b3dm:
    case ContentKind::i3dm:
      return of_gltf(tile, root);
    case ContentKind::obj:
      return of_obj(tile, files_of(tile, root));
    default:
      return std::nullopt;
  }
}

}  // namespace gigabake
