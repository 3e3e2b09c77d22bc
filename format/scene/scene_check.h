/// Whether a scene.xml agrees with itself: what can be known without its shards.
#pragma once

#include <span>
#include <vector>

#include "format/scene/scene_page.h"
#include "format/scene/scene_reading.h"

namespace gigabake {

/// Cells are windows of one lattice: no two have one name, file or place, nor have two parents of one level. Cost  one
/// pass.
std::vector<SceneFault> faults_of_places(const std::vector<SceneCell>& cells,
                                         const std::vector<SceneCell>& parents = {});

/// Parents that do not stand in the smallest page whose block they lie in, or are not of the tiers, if there are any.
/// outer: the page's own block; null of scene.xml, where the parents of the highest tier stand.
std::vector<SceneFault> faults_of_parent_places(const ScenePage& page, const LatticeBlock* outer,
                                                std::span<const TierShape> tiers);

/// Of what scene.xml itself lists: cells, or the references to pages; and parents. Then its totals, where it has any.
std::vector<SceneFault> faults_of_listed(const SceneReading& reading);

/// Cells that overlap another of `all` without standing at the same place; of a pair the first is named.
/// block: only those that begin in it are named, if it is one.
std::vector<SceneFault> overlaps_of_cells(const std::vector<SceneCell>& all, const LatticeBlock* block = nullptr);

/// `Parameters` are those of a bake, and of this scene; the size of cells is that of scene.xml's totals or cells.
std::vector<SceneFault> faults_of_parameters(const SceneReading& reading);

}  // namespace gigabake
