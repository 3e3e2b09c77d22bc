/// The content hash of whole levels, computed before constant bricks are removed.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "core/math/vec3.h"
#include "core/octree/voxel_hash.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Returns the sum of hash_voxel() over the voxels of one level. `window_min` is CellParameters::window_min.
/// Cost    About 6 ns per voxel and thread.
Hash128 level_hash(const Level& level, int lod, const Vec3i64& window_min, const ThreadPool& pool);

/// Returns level_hash() of each level, by lod.
std::vector<Hash128> level_hashes(const std::vector<Level>& levels, const Vec3i64& window_min, const ThreadPool& pool);

}  // namespace gigabake::kernels
