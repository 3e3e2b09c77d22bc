/// Checks of a scene.xml's consistency that need no shards.
#pragma once

#include <span>
#include <vector>

#include "format/scene/scene_page.h"
#include "format/scene/xml/scene_reading.h"

namespace gigabake {

/// Checks that cells are windows of one lattice. No two cells have the same name, file or position, and no two
/// overviews the same level and position.
/// Cost    One pass.
std::vector<SceneFault> faults_of_places(const std::vector<SceneCell>& cells,
                                         const std::vector<SceneCell>& overviews = {});

/// Checks that each overview is listed in the smallest page whose block contains it. Checks that it belongs to one of
/// `tiers`, if there are any.
/// outer: the page's own block; null for scene.xml, which lists the overviews of the highest level.
std::vector<SceneFault> faults_of_overview_places(const ScenePage& page, const LatticeBlock* outer,
                                                  std::span<const TierShape> tiers);

/// Checks what scene.xml itself lists: cells or page references, and overviews; then its totals, if it has any.
std::vector<SceneFault> faults_of_listed(const SceneReading& reading);

/// Returns cells that overlap another cell of `all` at a different position. Names the first cell of each pair.
/// block: if not null, only cells that begin in it are named.
std::vector<SceneFault> overlaps_of_cells(const std::vector<SceneCell>& all, const LatticeBlock* block = nullptr);

/// Checks that `Parameters` are valid and match the scene. The size of cells is taken from the cells or from the pages'
/// totals.
std::vector<SceneFault> faults_of_parameters(const SceneReading& reading);

}  // namespace gigabake
