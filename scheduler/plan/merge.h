/// Merges the workers' reports into a scene.
#pragma once

#include <optional>
#include <vector>

#include "core/octree/parameters.h"
#include "format/job/cell_job.h"
#include "scheduler/plan/plan.h"

namespace gigabake {

/// Returns the scene that the reports describe. `reports` may have any order; a job without a report counts as lost.
/// The scene lists first the plan's losses, then failed jobs. Jobs without a report, and overviews made without some of
/// their children, follow.
SceneDescription merge(const BakePlan& plan, const std::vector<CellReport>& reports,
                       const std::optional<Geodetic>& origin, const BakeParameters& parameters);

/// Returns the scene without cells, overviews and losses.
SceneHeader scene_header(const BakePlan& plan, const std::optional<Geodetic>& origin, const BakeParameters& parameters);

}  // namespace gigabake
