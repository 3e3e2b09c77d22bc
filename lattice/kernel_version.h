/// Which voxels the kernels make of the same triangles.
#pragma once

#include <cstdint>

namespace gigabake {

/// Raised whenever the kernels or the shard layout would give other bytes for the same inputs: every cell is then baked
/// again. A test (tests/kernels/cpu/kernel_version_test.cpp) fails where voxels change and this number does not.
inline constexpr std::uint32_t kernel_version = 8;

}  // namespace gigabake
