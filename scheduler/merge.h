/// From the workers' reports to the scene they make up.
#pragma once

#include <optional>
#include <vector>

#include "format/job/cell_job.h"
#include "lattice/parameters.h"
#include "scheduler/plan.h"

namespace gigabake {

/// reports: in any order; a job without one counts as lost. Losses: the plan's, then cells that failed, then
/// cells without a report.
SceneDescription merge(const BakePlan& plan, const std::vector<CellReport>& reports,
                       const std::optional<Geodetic>& origin, const BakeParameters& parameters);

}  // namespace gigabake
