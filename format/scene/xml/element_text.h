/// Writing of the elements of a scene.xml and of its pages.
#pragma once

#include <fmt/format.h>
#include <pugixml.hpp>
#include <string>

#include "core/base/valid_text.h"
#include "format/scene/check/scene_checksum.h"
#include "format/scene/scene_page.h"

namespace gigabake {

/// Writes the number so that reading it returns the same bits.
template <class T>
void set_number(pugi::xml_node node, const char* key, T value) {
  node.append_attribute(key) = fmt::format("{}", value).c_str();
}
template <class Numbers>
void set_numbers(pugi::xml_node node, const char* key, const Numbers& values) {
  node.append_attribute(key) = fmt::format("{}", fmt::join(values, " ")).c_str();
}
inline void set_text(pugi::xml_node node, const char* key, const std::string& value) {
  node.append_attribute(key) = xml_text(value).c_str();
}

/// Writes the version, and the attributes that readers of the thesis's schema require.
void set_schema(pugi::xml_node root, int version);
/// Writes voxel size, lattice and channels.
void set_lattice(pugi::xml_node root, const SceneHeader& scene);
void set_totals(pugi::xml_node group, const SceneTotals& totals);
void set_block(pugi::xml_node group, const LatticeBlock& block);

void append_cell(pugi::xml_node group, const SceneHeader& scene, const SceneCell& cell);
/// Appends the overviews in a separate group. Appends nothing if `overviews` is empty.
void append_overviews(pugi::xml_node group, const SceneHeader& scene, const std::vector<const SceneCell*>& overviews);
void append_reference(pugi::xml_node group, const SceneHeader& scene, const PageReference& page);

/// Returns the text of a document, with a `Checksum` added to its root.
SummedText summed_text(pugi::xml_document& document);

}  // namespace gigabake
