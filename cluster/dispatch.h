/// Handing out cells: rank 0 keeps every rank, itself included, supplied and collects the reports.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "cluster/mpi_session.h"
#include "format/cell_job.h"
#include "worker/cell_pipeline.h"

namespace gigabake {

/// Makes the rank's own pipeline. It may throw: then each of the rank's jobs fails with that line.
using MakePipeline = std::function<std::unique_ptr<CellPipeline>()>;

/// Rank 0. The reports in the order in which they came. on_report returns false to hand out nothing more; cells that
/// are out by then are still finished.
std::vector<CellReport> dispatch(MpiSession& mpi, const std::vector<CellJob>& jobs, const MakePipeline& make_pipeline,
                                 const std::function<bool(const CellReport&)>& on_report);

/// Every other rank: bakes what it is given until told to stop.
void work(MpiSession& mpi, const MakePipeline& make_pipeline);

}  // namespace gigabake
