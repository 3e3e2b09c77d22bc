#include "format/source/mesh/obj_material_table.h"

#include <algorithm>
#include <optional>

#include "format/source/image/alpha_image.h"
#include "format/source/source_file.h"
#include "lattice/error.h"

namespace gigabake {

void ObjMaterialTable::take(const ObjLine& line) {
  for (const std::filesystem::path& mtl : material_files(file_, line, files_)) {
    mtl_files_.insert(mtl);
    if (!files_.has(mtl))
      missing_.insert(mtl);
    else
      for (auto& [name, material] : read_mtl(mtl, files_.read(mtl))) named_[name] = {std::move(material), mtl};
  }
}

std::vector<SourceWarning> ObjMaterialTable::warnings() const {
  std::vector<SourceWarning> out;
  for (const std::filesystem::path& mtl : missing_)
    out.push_back("its material file " + in_quotes(name_in(files_.root(), mtl)) +
                  " is missing: what it describes is grey");
  return out;
}

std::vector<std::filesystem::path> ObjMaterialTable::dependencies() const {
  std::set<std::filesystem::path> out = mtl_files_;
  for (const auto& [name, m] : named_)
    for (const std::string& map : {m.material.color_map, m.material.alpha_map})
      if (!map.empty()) out.insert(map_file(m.file, map, files_));
  return {out.begin(), out.end()};
}

int ObjMaterialTable::add(const std::string& name, bool has_colours, ReadScope scope, TileMesh& out) {
  Material material;
  const auto found = named_.find(name);
  if (found == named_.end()) {
    if (!missing_.empty() && !has_colours) std::fill_n(material.base_color.begin(), 3, grey_without_image);
  } else if (scope == ReadScope::everything) {
    const ObjMaterial& m = found->second.material;
    material.base_color = m.base_color;
    material.texture.image = add_image(found->second, out);
    if (m.base_color[3] < 1 || !m.alpha_map.empty()) material.alpha_mode = AlphaMode::blend;
  }
  out.materials.push_back(material);
  return int(out.materials.size()) - 1;
}

/// The index of the colour map, the alpha map in it; -1 where the material has neither.
int ObjMaterialTable::add_image(const Named& m, TileMesh& out) {
  const std::string &color = m.material.color_map, &alpha = m.material.alpha_map;
  if (color.empty() && alpha.empty()) return -1;
  const std::string key = m.file.string() + "\n" + color + "\n" + alpha;
  const auto [at, is_new] = image_.try_emplace(key, int(out.images.size()));
  if (!is_new) return at->second;
  const auto load = [&](const std::string& name) {
    const std::filesystem::path file = map_file(m.file, name, files_);
    return EncodedImage{file.string(), files_.read(file)};
  };
  if (alpha.empty() || alpha == color)
    out.images.push_back(load(color));
  else
    out.images.push_back(with_alpha(color.empty() ? std::nullopt : std::optional(load(color)), load(alpha)));
  return at->second;
}

}  // namespace gigabake
