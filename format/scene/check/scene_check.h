/// Checks of a scene.xml's consistency that need no shards.
#pragma once

#include <span>
#include <vector>

#include "format/scene/scene_page.h"
#include "format/scene/xml/scene_reading.h"

namespace gigabake {

/// Checks that no two shards have the same name or file. No two cells may have the same position, and no two overviews
/// the same level and position.
/// Cost    One pass.
std::vector<SceneFault> faults_of_places(const std::vector<SceneCell>& cells,
                                         const std::vector<SceneCell>& overviews = {});

/// Checks that each overview is listed in the smallest page whose block contains it. An overview must also belong to
/// one of `tiers`, if there are any. `outer` is the page's own block; null for scene.xml, which must list the overviews
/// of the highest level.
std::vector<SceneFault> faults_of_overview_places(const ScenePage& page, const LatticeBlock* outer,
                                                  std::span<const TierShape> tiers);

/// Checks the lists in scene.xml itself (cells or page references, and overviews), and its totals, if it has any.
std::vector<SceneFault> faults_of_listed(const SceneReading& reading);

/// Returns a fault for each pair of cells in `all` that overlap at different positions. The fault names the first cell
/// of the pair. If `block` is not null, only pairs whose first cell begins in `block` are faults.
std::vector<SceneFault> overlaps_of_cells(const std::vector<SceneCell>& all, const LatticeBlock* block = nullptr);

/// Checks that `Parameters` are valid and match the scene. The cell size in the parameters is compared with the cells
/// and with the totals of the pages.
std::vector<SceneFault> faults_of_parameters(const SceneReading& reading);

}  // namespace gigabake
