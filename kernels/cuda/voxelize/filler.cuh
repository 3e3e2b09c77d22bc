/// Filling of all bricks of the finest level, batch by batch, with arrays that grow where they do not suffice.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/body/cell.h"
#include "kernels/cuda/voxelize/batch.cuh"

namespace gigabake::kernels {

/// Sizes of the arrays that fill a level. All except `bricks_per_batch` grow if they do not suffice. `stage_voxels` is
/// 0 if all marked voxels are visible.
struct FillSizes {
  std::uint32_t voxels, bricks_per_batch, pairs_per_batch, items_per_batch, stage_voxels;
};

/// The channels of a lod-0 voxel in addition to its colour.
struct FinestChannels {
  bool normals, planes;

  /// Returns the bytes of a voxel.
  std::size_t bytes() const {
    return sizeof(std::uint32_t) + (normals ? sizeof(std::uint16_t) : 0) + (planes ? directional_coverage_bytes : 0);
  }
};

/// All listed bricks, including empty bricks.
struct FilledBricks {
  DeviceArray<std::uint64_t> mask;
  DeviceArray<std::uint32_t> count, first, rgba;
  DeviceArray<std::uint16_t> normal;
  DeviceArray<std::uint8_t> directional_coverage;  ///< empty if lod-0 voxels have no planes
  BatchCounters counted{};

  std::uint32_t* plane() { return reinterpret_cast<std::uint32_t*>(directional_coverage.data()); }
};

/// Fills the listed bricks. If voxels may be invisible, a batch is first written to staging arrays. A batch that does
/// not fit stops the level: the host enlarges the arrays and continues with this batch.
/// Exact   The result does not depend on `sizes`.
/// Cost    Waits for the stream once, and again after each batch that did not fit.
/// Errors  CudaFailure, DeviceFull.
FilledBricks fill_bricks_of_level(DeviceHeap& heap, const InputView& input, SurfaceRule rule, const BrickLists& lists,
                                  FinestChannels channels, CellMaterials materials, const FillSizes& sizes);

}  // namespace gigabake::kernels
