/// Variable depth: voxels that differ by no more than they may become alike, so that a shard stores them once.
///
/// Colour, alpha, facing and normal go each by itself, by the rule of kernels/body/approximate.h.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/cell.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Changes the levels' voxels, not which there are.
/// Exact   No voxel's red, green, blue, alpha or facing changes by more than `codes` of 255, and no normal by a
///         chord of more than 2·codes/255, unit vectors as Tables::unit_normal has them. Depends on the brick alone.
/// Range   codes ≤ 127. 0: nothing changes.
void approximate(std::vector<Level>& levels, std::uint32_t codes, const ThreadPool& pool);

}  // namespace gigabake::kernels
