/// The levels above a block of cells, or of blocks: a parent, made of what its children keep for it.
///
/// A parent is a volume as a cell is one, of which level 0 is level child_lod + 1 of the lattice. It is made on the
/// host whatever bakes the cells: it has a five-hundredth of a cell's voxels, and what it is made of comes from files.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/body/cell.h"
#include "lattice/parent_source.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// A child, which may reach out of the parent's window: what lies outside is another parent's.
struct ParentChild {
  const ParentSource* source = nullptr;
  std::int64_t lattice_min[3] = {};  ///< lod-0 voxels, multiples of a voxel of its coarsest level
};

struct ParentParameters {
  std::int64_t window_min[3] = {};  ///< lod-0 voxels, multiples of a voxel of the parent's coarsest level
  int child_lod = 0;                ///< of all children's coarsest levels
  int levels = 0;                   ///< the window has 8 · 2^(child_lod + levels) voxels of lod 0 along its edge
  MipFilter mip = MipFilter::coverage;
  bool normals = true, facing = true;
  std::uint32_t max_error = 0;  ///< as CellParameters has it
};

/// Exact   The voxels that a single cell of the parent's window would have on these levels, before approximate(): where
///         children end, and in which order they are given, does not show in any bit.
/// copies  Levels of the children, joined over the window, from a finer one to child_lod: they come before its own.
/// Range   levels 1 … 10. children: all that the window overlaps, by the same rules; no two have a voxel of one place.
/// Cost    All bricks are stored: few of so few would be constant. Of the children's coarsest levels, read and sorted,
/// as much as a level of a cell. Errors  InputError: two children have a voxel of one place, or columns do not fit each
/// other or the rules.
CellVolume bake_parent(std::span<const ParentChild> children, const ParentParameters& parameters,
                       const ThreadPool& pool, std::vector<Level> copies = {});

}  // namespace gigabake::kernels
