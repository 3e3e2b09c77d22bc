/// Merges the workers' reports into a scene.
#pragma once

#include <optional>
#include <vector>

#include "core/octree/parameters.h"
#include "format/job/cell_job.h"
#include "scheduler/plan/plan.h"

namespace gigabake {

/// Returns the scene. reports: in any order; a job without a report counts as lost. Losses are ordered: first the
/// plan's, then failed cells, then cells without a report.
SceneDescription merge(const BakePlan& plan, const std::vector<CellReport>& reports,
                       const std::optional<Geodetic>& origin, const BakeParameters& parameters);

}  // namespace gigabake
