/// The elements of a scene.xml and of its pages, one by one: cells, references to pages, totals.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "format/scene/scene_attributes.h"
#include "format/scene/scene_page.h"
#include "format/scene/scene_reading.h"

namespace gigabake {

/// What a group lists.
struct GroupContent {
  std::vector<SceneCell> cells, parents;
  std::vector<PageReference> pages;
  std::vector<SceneLoss> losses;
  std::vector<SceneFault> faults;  ///< what no voxel depends on
};

/// Below `group`, and in groups that stand in it; `known` are the attributes that these may have. header: its voxel
/// size and lattice are looked at. Errors  InputError: an element that says where or what voxels are misses that, or
/// says it wrongly.
GroupContent read_content(const std::filesystem::path& file, pugi::xml_node group, const SceneHeader& header,
                          int version, std::span<const std::string_view> known);

/// The one OctTreeGroup of a document; others beside it are faults. Errors  InputError: there is none.
pugi::xml_node root_of(const std::filesystem::path& file, const pugi::xml_document& document,
                       std::vector<SceneFault>& faults);

/// Errors (all)  InputError, as above.
/// Before version 5 without parents.
SceneTotals read_totals(const SceneAttributes& a, int version);
LatticeBlock read_block(const SceneAttributes& a);
/// Voxel size, lattice and channels.
void read_lattice(const SceneAttributes& a, SceneHeader& header);

/// What readers of the thesis's schema look at in a root, and ours do not; `known` are the attributes that may be
/// there.
std::vector<SceneFault> faults_of_root(const SceneAttributes& root, std::span<const std::string_view> known);

/// The names of a group's totals, and then those of `others`.
std::vector<std::string_view> with_totals(std::vector<std::string_view> others);

/// Blocks of pages that are not of one size, stand twice, or do not lie in `outer`, the group's own, if it has one.
std::vector<SceneFault> faults_of_blocks(const std::vector<PageReference>& pages, const LatticeBlock* outer);

/// What `said` says otherwise than `are`, by attribute.
std::vector<SceneFault> faults_of_totals(const SceneTotals& said, const SceneTotals& are, const std::string& element);

}  // namespace gigabake
