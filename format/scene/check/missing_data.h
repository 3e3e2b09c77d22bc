/// Counts of the data that a bake was to produce and its scene lacks.
#pragma once

#include <cstdint>
#include <string>

#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Counts of the losses that a scene records. An overview is a shard of the levels above the cells. Overviews are
/// counted only if no cell is missing, because overviews above a missing cell are incomplete with it.
struct MissingData {
  std::uint64_t cells = 0, overviews = 0, inputs = 0;
  std::uint64_t planned_cells = 0;  ///< cells of the scene plus missing cells

  bool any() const { return cells + overviews + inputs != 0; }
};

/// Counts the losses. `cells` is the number of cells that the scene has.
MissingData missing_data(const SceneHeader& scene, std::uint64_t cells);

/// Returns "9 of 16 cells are missing", or "1 of 4 cells, 1 overview and 2 inputs are missing".
/// Range   missing.any().
std::string describe(const MissingData& missing);

}  // namespace gigabake
