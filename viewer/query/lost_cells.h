/// Where the cells stood that a bake lost: a ray that comes there must not go on as if nothing were there.
#pragma once

#include <vector>

#include "format/scene/scene_xml.h"

namespace gigabake {

/// Stand-ins for the cells that the scene says it lost, without a file. A lost cell's name says its column and where in
/// its column's stack it stood; where a stack begins, only its other cells say. Where there are none, stand-ins of the
/// same name fill the column as high as the scene is.
/// Range  cells: all of the scene, of one size; at least one.
std::vector<SceneCell> lost_cells(const SceneHeader& scene, const std::vector<SceneCell>& cells);

/// Whether the scene says that it lost a cell.
bool lacks_cells(const SceneHeader& scene);

}  // namespace gigabake
