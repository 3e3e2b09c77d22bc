/// Voxels, bytes and minutes of a bake, for the requested voxel size and its neighbours.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cluster/bake/plan_measure.h"

namespace gigabake::app {

struct PlanSizes {
  PlanMeasure measure;
  double scan_s = 0;  ///< duration of the scan before the first cell
};

/// Returns a table, the basis of its numbers, and the voxel size that the textures suggest.
std::string sizes_text(const PlanSizes& sizes);
void add_sizes(const PlanSizes& sizes, nlohmann::ordered_json& j);

}  // namespace gigabake::app
