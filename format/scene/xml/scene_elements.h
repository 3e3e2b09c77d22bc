/// Reading of the elements of a scene.xml and of its pages: cells, page references, totals.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "format/scene/scene_page.h"
#include "format/scene/xml/scene_attributes.h"
#include "format/scene/xml/scene_reading.h"

namespace gigabake {

/// The content of a group.
struct GroupContent {
  std::vector<SceneCell> cells, overviews;
  std::vector<PageReference> pages;
  std::vector<SceneLoss> losses;
  std::vector<SceneFault> faults;  ///< faults that do not affect any voxel
};

/// Reads the elements of `group` and of groups nested in it. `known` lists the attributes that these groups may have.
/// Uses the voxel size and lattice of `header`.
/// Errors  InputError if an attribute that determines voxels or their positions is missing or malformed.
GroupContent read_content(const std::filesystem::path& file, pugi::xml_node group, const SceneHeader& header,
                          int version, std::span<const std::string_view> known);

/// Returns the root element OctTreeGroup of a document. Appends a fault to `faults` for each further root element.
/// Errors  InputError if there is no OctTreeGroup.
pugi::xml_node root_of(const std::filesystem::path& file, const pugi::xml_document& document,
                       std::vector<SceneFault>& faults);

/// Reads the totals of a group. Totals before version 5 do not count overviews.
/// Errors  InputError if an attribute is missing or malformed; the functions below throw it too.
SceneTotals read_totals(const SceneAttributes& a, int version);
LatticeBlock read_block(const SceneAttributes& a);
/// Reads a half-open box of the lattice from two attributes.
Box3i64 read_box(const SceneAttributes& a, const char* min_key, const char* end_key);
/// Reads voxel size, lattice and channels.
void read_lattice(const SceneAttributes& a, SceneHeader& header);

/// Returns faults of the root attributes that only readers of the thesis's schema use. Also returns faults of
/// attributes that are not in `known`.
std::vector<SceneFault> faults_of_root(const SceneAttributes& root, std::span<const std::string_view> known);

/// Returns the attribute names of a group's totals, followed by `others`.
std::vector<std::string_view> with_totals(std::vector<std::string_view> others);

/// Returns faults of pages' blocks: different sizes, duplicates, or blocks outside of `outer`. `outer` is the block of
/// the group that lists the pages; null if the group has no block.
std::vector<SceneFault> faults_of_blocks(const std::vector<PageReference>& pages, const LatticeBlock* outer);

/// Returns one fault per attribute in which the stored totals `said` differ from the computed totals `are`.
std::vector<SceneFault> faults_of_totals(const SceneTotals& said, const SceneTotals& are, const std::string& element);

}  // namespace gigabake
