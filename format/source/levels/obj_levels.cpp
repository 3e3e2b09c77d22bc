#include "format/source/levels/obj_levels.h"

#include "format/source/mesh/obj_lines.h"

namespace gigabake {

void ObjLevels::restart() {
  of_group_ = of_object_ = not_stated;
  of_material_ = lod_of_material(sizes_, "");
}

void ObjLevels::take(std::string_view word, std::string_view rest) {
  if (sizes_ == nullptr) return;
  if (word == "usemtl") of_material_ = lod_of_material(sizes_, rest);
  if (word == "o") of_object_ = lod_of_named(rest);
  if (word != "g") return;
  of_group_ = lod_of_named(rest);
  while (of_group_ == not_stated && !rest.empty()) of_group_ = lod_of_named(take_word(rest));
}

std::int32_t ObjLevels::lod() const {
  for (const std::int32_t lod : {of_material_, of_group_, of_object_})
    if (lod != not_stated) return lod;
  return not_stated;
}

std::vector<std::uint32_t> ObjLevels::sized(const std::set<std::string>& materials) const {
  return sized_names(sizes_, materials, nodes_);
}

/// Returns the level of a node's name, which the file has.
std::int32_t ObjLevels::lod_of_named(std::string_view name) {
  const std::int32_t lod = lod_of_node(sizes_, name);
  if (lod != not_stated) nodes_.emplace(name);
  return lod;
}

}  // namespace gigabake
