/// The content hash of whole levels, before constant bricks leave them.
#pragma once

#include <vector>

#include "kernels/body/cell.h"
#include "lattice/thread_pool.h"
#include "lattice/voxel_hash.h"

namespace gigabake::kernels {

/// The sum of hash_voxel() over the voxels of one level. window_min: CellParameters::window_min.
/// Cost   About 6 ns a voxel and thread.
Hash128 level_hash(const Level& level, int lod, const std::int64_t window_min[3], const ThreadPool& pool);

/// Per lod.
std::vector<Hash128> level_hashes(const std::vector<Level>& levels, const std::int64_t window_min[3],
                                  const ThreadPool& pool);

}  // namespace gigabake::kernels
