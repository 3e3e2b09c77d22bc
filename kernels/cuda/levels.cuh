/// Stages 5 and 6 on the device: coarser levels and the node table.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/patch.h"
#include "kernels/body/tables.h"
#include "kernels/cuda/device_level.cuh"
#include "lattice/rules.h"

namespace gigabake::kernels {

struct LevelsAbove {
  std::vector<DeviceLevel> levels;     ///< from lod 1 on
  DeviceArray<std::uint32_t> rasters;  ///< of the last one (kernels/body/facing.h); empty without MipFilter::coverage
  DeviceArray<Patch> patches;          ///< of the last one (kernels/body/patch.h); empty without it or normals
};

/// The levels [1, lods).
/// Cost    With MipFilter::coverage 4 bytes of working memory a voxel of lod 1 of a surface.
/// Errors  CudaFailure.
LevelsAbove coarser_levels(DeviceHeap& heap, const Tables& tables, const DeviceLevel& finest, int lods,
                           MipFilter filter, bool normals);

/// Nodes on the device. Where every one of them is a brick, what only others have is empty.
struct DeviceNodes {
  DeviceArray<std::uint32_t> key, first_child, value;
  DeviceArray<std::uint8_t> lod, child_mask;
  DeviceArray<NodeKind> kind;
  DeviceArray<std::uint16_t> normal;
  DeviceArray<std::uint32_t> facing;
  std::uint32_t count = 0;
};

/// Of that many, what every one has; not set.
DeviceNodes make_device_nodes(DeviceHeap& heap, std::uint32_t count);

/// levels: [lod]. Empty where a brick may be constant: then prune_levels() decides, or prune() on the host.
/// Errors  CudaFailure; std::length_error beyond 2^32-1 nodes.
DeviceNodes brick_nodes(DeviceHeap& heap, const std::vector<DeviceLevel>& levels);

}  // namespace gigabake::kernels
