#include "format/source/mesh/obj_material_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "format/source/image/alpha_image.h"
#include "format/source/image/grey_image.h"
#include "format/source/image/image_file.h"
#include "format/source/invisible_material.h"

namespace gigabake {
void ObjMaterialTable::take(const ObjLine& line) {
  for (const NamedFile& mtl : material_files(file_, line, files_)) {
    if (mtl.file && !mtl_files_.insert(*mtl.file).second) continue;
    if (!mtl.is_there(files_))
      missing_.insert(mtl.name);
    else
      for (const auto& [name, material] : read_mtl(*mtl.file, files_.read(*mtl.file), mtl_warnings_))
        describe(name, {material, *mtl.file});
  }
}

/// Adds a material. A name ends before a comment, unless a material or a file has the whole text as its name.
void ObjMaterialTable::describe(const std::string& name, Described described) {
  ObjMaterial& m = described.material;
  for (ObjMap* map : {&m.color_map, &m.alpha_map, &m.normal_map}) {
    const std::string plain(without_comment(map->name));
    if (plain != map->name && !named_file(described.file, map->name, files_).is_there(files_)) map->name = plain;
  }
  described_.try_emplace(std::string(without_comment(name)), described);
  described_[name] = std::move(described);
}

const ObjMaterialTable::Described* ObjMaterialTable::find(const std::string& name) const {
  auto at = described_.find(name);
  if (at == described_.end()) at = described_.find(std::string(without_comment(name)));
  return at == described_.end() ? nullptr : &at->second;
}

bool ObjMaterialTable::is_usable(const Described& m, const ObjMap& map) const {
  const NamedFile image = named_file(m.file, map.name, files_);
  return !map.name.empty() && image.is_there(files_) && is_image_file(files_, *image.file);
}

bool ObjMaterialTable::has_image(const std::string& name) const {
  const Described* m = find(name);
  return m != nullptr && (is_usable(*m, m->material.color_map) || is_usable(*m, m->material.alpha_map));
}

ObjMap ObjMaterialTable::placed_map(const std::string& name) const {
  const Described* m = find(name);
  return m == nullptr ? ObjMap() : m->material.placed_map();
}

void ObjMaterialTable::warn(const std::set<std::string>& used, SourceWarnings& warnings) const {
  for (const std::string& mtl : missing_)
    warnings.count("material files are missing, their materials are grey", in_quotes(mtl));
  warnings.add(mtl_warnings_);
  std::size_t named = 0;
  for (const std::string& name : used) {
    if (name.empty()) continue;
    ++named;
    const Described* m = find(name);
    if (m == nullptr && missing_.empty())
      warnings.count("materials that faces use and no file defines, taken as white", in_quotes(name));
    if (m == nullptr) continue;
    const ObjMaterial& material = m->material;
    if (material.base_color[3] < min_visible_alpha)
      warnings.count("materials with alpha 0, whose faces are invisible", in_quotes(name));
    for (const ObjMap& map : {material.color_map, material.alpha_map}) {
      if (map.name.empty() || is_usable(*m, map)) continue;
      const bool is_there = named_file(m->file, map.name, files_).is_there(files_);
      warnings.count(
          is_there ? "images are not PNG, JPEG or WebP, replaced by grey" : "images are missing, replaced by grey",
          in_quotes(map.name));
    }
    if (!material.color_map.name.empty() && !material.alpha_map.name.empty() &&
        !material.color_map.is_placed_as(material.alpha_map))
      warnings.count("materials whose map_d has other options than map_Kd, which are not applied", in_quotes(name));
  }
  warnings.set_of("materials that faces use and no file defines, taken as white", named);
}

std::vector<std::filesystem::path> ObjMaterialTable::dependencies() const {
  std::set<std::filesystem::path> out = mtl_files_;
  for (const auto& [name, m] : described_)
    for (const ObjMap& map : {m.material.color_map, m.material.alpha_map, m.material.normal_map})
      if (!map.name.empty())
        if (const NamedFile image = named_file(m.file, map.name, files_); image.file) out.insert(*image.file);
  return {out.begin(), out.end()};
}

bool ObjMaterialTable::has_normal_map(const Described& m) const {
  if (!is_usable(m, m.material.normal_map)) return false;
  const std::filesystem::path file = *named_file(m.file, m.material.normal_map.name, files_).file;
  const auto known = is_grey_.find(file);
  if (known != is_grey_.end()) return !known->second;
  bool grey = true;
  try {
    grey = is_grey(load(m, m.material.normal_map));
  } catch (const InputError&) {
    // A damaged image counts as unusable, like a height map.
  }
  is_grey_.emplace(file, grey);
  return !grey;
}

void ObjMaterialTable::warn_of_normal_map(const ObjMaterialUse& use, SourceWarnings& warnings) const {
  const Described* m = find(use.name);
  if (m == nullptr || m->material.normal_map.name.empty()) return;
  if (!is_usable(*m, m->material.normal_map))
    warnings.count("normal maps (norm, bump) that are missing or no PNG, JPEG or WebP, not used",
                   in_quotes(m->material.normal_map.name));
  else if (!has_normal_map(*m))
    warnings.count("grey or damaged images in place of normal maps (height maps), not used",
                   in_quotes(m->material.normal_map.name));
  else if (!use.has_uv)
    warnings.count("normal maps without the texture coordinates that they require, not used", in_quotes(use.name));
}

std::optional<ObjMap> ObjMaterialTable::placed_normal_map(const ObjMaterialUse& use) const {
  const Described* m = find(use.name);
  if (m == nullptr || !use.has_uv || !has_normal_map(*m)) return std::nullopt;
  return m->material.normal_map;
}

int ObjMaterialTable::add(const ObjMaterialUse& use, bool with_normals, TileMesh& out) {
  Material material;
  const Described* m = find(use.name);
  const auto make_grey = [&] {
    if (!use.has_colour) std::fill_n(material.base_color.begin(), 3, grey_without_image);
  };
  if (m == nullptr) {
    if (!missing_.empty() && !use.name.empty()) make_grey();
  } else {
    material.base_color = m->material.base_color;
    const bool is_placed = use.has_uv || !m->material.has_map();
    if (is_placed) material.texture.image = add_image(*m, m->material.color_map, m->material.alpha_map, out);
    if (m->material.placed_map().is_clamped) material.texture.wrap_s = material.texture.wrap_t = Wrap::clamp_to_edge;
    // Many programs write a black Kd for materials that have an image.
    const bool has_colour_map = !m->material.color_map.name.empty();
    if (has_colour_map && use.has_uv) std::fill_n(material.base_color.begin(), 3, 1.0f);
    if (has_colour_map && use.has_uv && !is_usable(*m, m->material.color_map)) make_grey();
    if (material.base_color[3] < 1 || (is_placed && is_usable(*m, m->material.alpha_map)))
      material.alpha_mode = AlphaMode::blend;
    if (with_normals && use.has_uv && has_normal_map(*m)) {
      const ObjMap& map = m->material.normal_map;
      TextureUse& texture = material.normal_map.texture;
      texture.image = add_image(*m, map, {}, out);
      if (map.is_clamped) texture.wrap_s = texture.wrap_t = Wrap::clamp_to_edge;
      if (std::fabs(map.bump_scale) <= double(std::numeric_limits<float>::max()))
        material.normal_map.scale = float(map.bump_scale);
    }
  }
  out.materials.push_back(material);
  return int(out.materials.size()) - 1;
}

EncodedImage ObjMaterialTable::load(const Described& m, const ObjMap& map) const {
  const std::filesystem::path file = *named_file(m.file, map.name, files_).file;
  return {file.string(), files_.read(file)};
}

/// Returns the index of the image that combines `color` and `alpha`; -1 if neither can be read.
int ObjMaterialTable::add_image(const Described& m, const ObjMap& color, const ObjMap& alpha, TileMesh& out) {
  const bool has_color = is_usable(m, color), has_alpha = is_usable(m, alpha);
  if (!has_color && !has_alpha) return -1;
  const std::string key = m.file.string() + "\n" + color.name + "\n" + alpha.name;
  const auto [at, is_new] = image_.try_emplace(key, int(out.images.size()));
  if (!is_new) return at->second;
  if (!has_alpha || alpha.name == color.name)
    out.images.push_back(load(m, color));
  else
    out.images.push_back(with_alpha(has_color ? std::optional(load(m, color)) : std::nullopt, load(m, alpha)));
  return at->second;
}

}  // namespace gigabake
