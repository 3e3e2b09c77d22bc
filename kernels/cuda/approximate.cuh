/// approximate() of kernels/cpu on the device: voxels that differ by no more than they may become alike.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/tables.h"
#include "kernels/cuda/device_level.cuh"

namespace gigabake::kernels {

/// Changes the levels' voxels, not which there are. Does not wait for the stream.
/// Exact   As kernels/cpu/approximate.h.
/// Errors  CudaFailure.
void approximate_levels(DeviceHeap& heap, const Tables& tables, std::uint32_t codes, std::vector<DeviceLevel>& levels);

}  // namespace gigabake::kernels
