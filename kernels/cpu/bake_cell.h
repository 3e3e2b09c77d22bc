/// Bakes a cell on the host's threads. This is the reference: all other backends produce the same bits.
#pragma once

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

CellVolume bake_cell(const CellInput& input, const CellParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake::kernels
