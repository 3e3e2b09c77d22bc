/// Converts the bake's parameters and a cell's job to kernel parameters.
#pragma once

#include <cstdint>

#include "core/octree/parameters.h"
#include "format/job/cell_job.h"
#include "kernels/body/cell.h"
#include "kernels/cpu/mip/overview.h"

namespace gigabake {

/// Returns the kernel parameters of a cell. `kernel_bytes` is the target for the kernels' working memory; 0 means no
/// limit.
kernels::CellParameters cell_parameters(const CellJob& job, const BakeParameters& parameters,
                                        std::uint64_t kernel_bytes);

/// Returns the kernel parameters of an overview.
kernels::OverviewParameters overview_parameters(const CellJob& job, const BakeParameters& parameters);

}  // namespace gigabake
