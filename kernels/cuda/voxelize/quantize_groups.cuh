/// Device version of kernels/cpu's quantize_groups(): makes voxels equal that differ by no more than the permitted
/// error.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/tables.h"
#include "kernels/cuda/mip/device_level.cuh"

namespace gigabake::kernels {

/// Changes the values of voxels but not the set of voxels. Does not wait for the stream.
/// Exact   Same values as kernels/cpu/voxelize/quantize_groups.h.
/// Errors  CudaFailure.
void approximate_levels(DeviceHeap& heap, const Tables& tables, std::uint32_t codes, std::vector<DeviceLevel>& levels);

}  // namespace gigabake::kernels
