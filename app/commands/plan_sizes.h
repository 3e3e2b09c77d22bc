/// Voxels, bytes and minutes of a bake, for the voxel size that was asked for and its neighbours.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cluster/plan_measure.h"

namespace gigabake::app {

struct PlanSizes {
  PlanMeasure measure;
  double survey_s = 0;  ///< that a bake spends before its first cell
};

/// A table, what it stands on, and which voxel size the textures suggest.
std::string sizes_text(const PlanSizes& sizes);
void add_sizes(const PlanSizes& sizes, nlohmann::ordered_json& j);

}  // namespace gigabake::app
