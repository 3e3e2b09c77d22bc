/// Stages 5 and 6 of a bake on the device: coarser levels and the node table.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/rules.h"
#include "kernels/body/mip/patch.h"
#include "kernels/body/tables.h"
#include "kernels/cuda/mip/device_level.cuh"

namespace gigabake::kernels {

struct LevelsAbove {
  std::vector<DeviceLevel> levels;  ///< of lods 1 and coarser
  DeviceArray<std::uint32_t>
      rasters;  ///< coverage masks of the coarsest level (kernels/body/mip/directional_coverage.h); empty without
                ///< MipFilter::coverage
  DeviceArray<SurfaceMoments> patches;  ///< patches of the coarsest level (kernels/body/mip/patch.h); empty without
                                        ///< MipFilter::coverage or normals
};

/// Computes the levels [1, lods).
/// Cost    MipFilter::coverage takes about 4 bytes of working memory per lod-1 voxel, if the voxels form a surface.
/// Errors  CudaFailure.
LevelsAbove coarser_levels(DeviceHeap& heap, const Tables& tables, const DeviceLevel& finest, int lods,
                           MipFilter filter, bool normals);

/// Node table on the device. If every node is a brick, the arrays that only other nodes use are empty.
struct DeviceNodes {
  DeviceArray<std::uint32_t> key, first_child, value;
  DeviceArray<std::uint8_t> lod, child_mask;
  DeviceArray<NodeKind> kind;
  DeviceArray<std::uint16_t> normal;
  DeviceArray<std::uint32_t> directional_coverage;
  std::uint32_t count = 0;
};

/// Allocates the arrays that every node uses, for `count` nodes; does not initialise them.
DeviceNodes make_device_nodes(DeviceHeap& heap, std::uint32_t count);

/// Returns the node table of levels[lod] if every node is a brick. Returns an empty table if any brick is full and thus
/// may be constant; then prune_levels() or the host's prune() must make the table.
/// Errors  CudaFailure; std::length_error for 2^32-1 nodes or more.
DeviceNodes brick_nodes(DeviceHeap& heap, const std::vector<DeviceLevel>& levels);

}  // namespace gigabake::kernels
