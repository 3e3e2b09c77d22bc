/// The content hash of whole levels, before constant bricks leave them.
#pragma once

#include <vector>

#include "kernels/cell.h"
#include "kernels/voxel_hash.h"

namespace gigabake::kernels {

/// Per lod, the sum of hash_voxel() over its voxels. window_min: CellParameters::window_min.
/// Cost   About 6 ns a voxel and thread.
std::vector<Sum128> level_hashes(const std::vector<Level>& levels, const std::int64_t window_min[3],
                                 const CpuPolicy& policy);

}  // namespace gigabake::kernels
