/// Whether a scene.xml agrees with itself: what can be known without its shards.
#pragma once

#include <vector>

#include "format/scene/scene_reading.h"

namespace gigabake {

/// Cells are windows of one lattice: no two have one name, file or place. Then the root's totals, where it has any.
/// Cost  one pass.
std::vector<SceneFault> faults_of_cells(const SceneReading& reading);

/// Cells that overlap without standing at the same place.
std::vector<SceneFault> overlaps_of_cells(const SceneDescription& scene);

/// `Parameters` are those of a bake, and of this scene.
std::vector<SceneFault> faults_of_parameters(const SceneReading& reading);

}  // namespace gigabake
