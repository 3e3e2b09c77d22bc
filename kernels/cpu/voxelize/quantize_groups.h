/// Lossy quantization: voxels of a group become equal within the allowed error, so that a shard stores one value for
/// them.
///
/// Colour, alpha, directional coverage and normal are quantized separately, by the rule of
/// kernels/body/voxelize/quantize_groups.h.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Changes the values of the levels' voxels but not which voxels exist.
/// Exact   Red, green, blue, alpha and directional coverage of a voxel change by at most codes/255. A normal moves by a
///         chord of at most 2·codes/255, measured between the unit vectors of Tables::unit_normal. The result of a
///         brick depends only on this brick.
/// Range   codes ≤ 127. If it is 0, nothing changes.
void quantize_groups(std::vector<Level>& levels, std::uint32_t codes, const ThreadPool& pool);

}  // namespace gigabake::kernels
