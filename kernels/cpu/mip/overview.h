/// An overview of a block of cells or of a block of overviews, computed from the downsample states of its children.
///
/// An overview is a volume like a cell. If it has no duplicated levels, its level 0 is level child_lod + 1 of the
/// lattice. It is always computed on the host, because it has only 1/500 of a cell's voxels and its input is read from
/// files.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/thread_pool.h"
#include "core/math/vec3.h"
#include "core/octree/downsample_state.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// A child. It may extend beyond the overview's window; the voxels outside belong to another overview.
struct JoinedChild {
  const DownsampleState* source = nullptr;
  Vec3i64 lattice_min{};  ///< in lod-0 voxels; multiples of the voxel edge of the child's coarsest level
};

struct OverviewParameters {
  Vec3i64 window_min{};  ///< in lod-0 voxels; multiples of the voxel edge of the overview's coarsest level
  int child_lod = 0;     ///< the coarsest lod of every child
  int levels = 0;        ///< the window has 8 · 2^(child_lod + levels) voxels of lod 0 along its edge
  MipFilter mip = MipFilter::coverage;
  bool normals = true, directional_coverage = true;
  bool classes = false;         ///< as in CellParameters
  std::uint32_t max_error = 0;  ///< as in CellParameters
};

/// Computes the overview of `children`. `copies` are the duplicated levels: consecutive levels of the children up to
/// child_lod, joined over the window. They precede the new levels.
/// Exact   Before quantize_groups(), the voxels equal the voxels of one cell with the overview's window. The boundaries
///         and the order of the children do not change any bit.
/// Range   `levels` is 1 … 10. `children` are all children that overlap the window. They are baked by the same rules
///         and have no voxel in common.
/// Cost    Reads and sorts the children's coarsest levels, about as much data as a level of a cell. Stores all bricks:
///         an overview has few bricks, and few of them would be constant.
/// Errors  InputError if two children have a voxel at the same position, or if columns of a child do not match each
///         other or the rules of an overview.
CellVolume bake_overview(std::span<const JoinedChild> children, const OverviewParameters& parameters,
                         const ThreadPool& pool, std::vector<Level> copies = {});

}  // namespace gigabake::kernels
