/// From the workers' reports to the scene they make up.
#pragma once

#include <vector>

#include "format/cell_job.h"
#include "format/parameters.h"
#include "format/source.h"
#include "scheduler/plan.h"

namespace gigabake {

/// reports: in any order; a job without one counts as lost. Losses: what the source lacks, tiles that could not be
/// read, cells that failed.
SceneDescription merge(const BakePlan& plan, const std::vector<CellReport>& reports, const SceneSources& sources,
                       const BakeParameters& parameters);

}  // namespace gigabake
