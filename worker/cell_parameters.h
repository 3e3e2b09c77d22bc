/// From the bake's parameters and a cell's job to what the kernels are told.
#pragma once

#include <cstdint>

#include "format/job/cell_job.h"
#include "kernels/body/cell.h"
#include "kernels/cpu/parent.h"
#include "lattice/parameters.h"

namespace gigabake {

/// kernel_bytes: working memory to aim for; 0: no bound.
kernels::CellParameters cell_parameters(const CellJob& job, const BakeParameters& parameters,
                                        std::uint64_t kernel_bytes);

/// Of a parent's job.
kernels::ParentParameters parent_parameters(const CellJob& job, const BakeParameters& parameters);

}  // namespace gigabake
