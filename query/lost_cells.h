/// Placeholders for the cells that a bake lost: a ray that reaches a lost cell must not continue as if it were empty.
#pragma once

#include <vector>

#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Returns placeholder cells, without a file, for the cells that the scene lists as lost.
/// The name of a lost cell gives its column and its index in the column's stack. The base of a stack follows from the
/// other cells of the column. If a column has no other cell, placeholders of the same name fill the column over the
/// height of the scene.
/// Range   `cells` are all cells of the scene, at least one, of equal size.
/// Errors  InputError: the name of a lost cell is not `c_X_Y_Z`.
std::vector<SceneCell> lost_cells(const SceneHeader& scene, const std::vector<SceneCell>& cells);

/// Returns whether the scene lists a lost cell.
bool has_lost_cells(const SceneHeader& scene);

}  // namespace gigabake
