/// The version of the kernels' results.
#pragma once

#include <cstdint>

namespace gigabake {

/// The version to raise when the kernels or the shard layout would produce other bytes for the same inputs. All cells
/// are then baked again. tests/kernels/cpu/kernel_version_test.cpp fails if voxels change and this number does not.
inline constexpr std::uint32_t kernel_version = 14;

}  // namespace gigabake
