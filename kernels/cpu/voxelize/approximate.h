/// Lossy quantization: voxels of a group become equal within the allowed error, so that a shard stores them once.
///
/// Colour, alpha, facing and normal are quantized separately by the rule of kernels/body/voxelize/approximate.h.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Changes the values of the levels' voxels but not which voxels exist.
/// Exact   No voxel's red, green, blue, alpha or facing changes by more than `codes` of 255. No normal changes by a
///         chord of more than 2·codes/255, measured between the unit vectors of Tables::unit_normal. The result depends
///         only on the brick.
/// Range   codes ≤ 127. If it is 0, nothing changes.
void approximate(std::vector<Level>& levels, std::uint32_t codes, const ThreadPool& pool);

}  // namespace gigabake::kernels
