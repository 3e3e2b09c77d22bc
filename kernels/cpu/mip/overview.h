/// An overview of a block of cells or of a block of overviews, computed from the data that its children store for it.
///
/// An overview is a volume like a cell; its level 0 is level child_lod + 1 of the lattice. It is always computed on the
/// host, because it has only 1/500 of a cell's voxels and its input is read from files.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/thread_pool.h"
#include "core/octree/downsample_state.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// A child. It may extend beyond the overview's window; the voxels outside belong to another overview.
struct JoinedChild {
  const DownsampleState* source = nullptr;
  std::int64_t lattice_min[3] = {};  ///< lod-0 voxels, multiples of a voxel of the child's coarsest level
};

struct OverviewParameters {
  std::int64_t window_min[3] = {};  ///< lod-0 voxels, multiples of a voxel of the overview's coarsest level
  int child_lod = 0;                ///< the coarsest lod of all children
  int levels = 0;                   ///< the window has 8 · 2^(child_lod + levels) voxels of lod 0 along its edge
  MipFilter mip = MipFilter::coverage;
  bool normals = true, facing = true;
  std::uint32_t max_error = 0;  ///< as in CellParameters
};

/// Computes the overview of `children`.
/// copies  The children's levels from a finer one to child_lod, joined over the window; they precede the new levels.
/// Exact   Before approximate(), the voxels equal the voxels of one cell with the overview's window. The boundaries
///         and the order of the children do not change any bit.
/// Range   levels 1 … 10. children: all children in reach of the window, baked by the same rules, with disjoint voxels.
/// Cost    Reads and sorts the children's coarsest levels, about as much data as a level of a cell. Stores all bricks,
///         because few of an overview's few bricks would be constant.
/// Errors  InputError if two children have the same voxel, or if columns do not fit each other or the rules.
CellVolume bake_overview(std::span<const JoinedChild> children, const OverviewParameters& parameters,
                         const ThreadPool& pool, std::vector<Level> copies = {});

}  // namespace gigabake::kernels
