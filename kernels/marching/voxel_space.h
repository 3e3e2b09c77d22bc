/// The space of rays: lod-0 voxels of a scene's lattice, its bounds and the edges of coarser voxels.
#pragma once

#include <bit>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"

namespace gigabake::kernels {

inline constexpr std::int64_t far_voxel = std::int64_t(1) << 52;  ///< beyond every scene; exact in a double

/// Returns 2^exponent. Multiplying by the result is exact and replaces a division by the length of an edge.
/// Exact   The result is assembled from its bits.
/// Range   -1000 … 1000.
GB_HD double power_of_two(int exponent) { return std::bit_cast<double>(std::uint64_t(1023 + exponent) << 52); }

/// Voxels [min, max).
struct VoxelBox {
  Vec3i64 min, max;
};

}  // namespace gigabake::kernels
