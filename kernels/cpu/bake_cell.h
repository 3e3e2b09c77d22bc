/// A cell baked by the host's threads: the reference that every other backend equals bit for bit.
#pragma once

#include "kernels/body/cell.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

CellVolume bake_cell(const CellInput& input, const CellParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake::kernels
