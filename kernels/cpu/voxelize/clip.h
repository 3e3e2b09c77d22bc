/// Removal of the voxels that a cell does not keep, before coarser levels are computed.
#pragma once

#include <cstdint>
#include <functional>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Removes all voxels that parameters.kept excludes, and bricks without voxels. Other voxels keep all bits. The level
/// has the keys of level `lod` of the cell.
/// Range   parameters.kept is not empty.
void clip(Level& level, int lod, const CellParameters& parameters, const ThreadPool& pool);

/// A function that returns the voxels of a brick that are kept. Threads call it concurrently.
using KeptInBrick = std::function<VoxelMask(std::uint64_t key)>;

/// Removes all voxels that `kept_in` excludes, as clip() does.
void keep_voxels(Level& level, const KeptInBrick& kept_in, const ThreadPool& pool);

}  // namespace gigabake::kernels
