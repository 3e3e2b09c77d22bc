/// Duplicated levels of an overview: the coarsest levels of its children, joined in the overview's window. Its shard
/// repeats them, so that a distant view opens one file instead of many.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/math/vec3.h"
#include "format/shard/levels/coarse_levels.h"
#include "format/shard/shard_reader.h"
#include "kernels/body/cell.h"

namespace gigabake {

/// A child's voxels on levels [begin, …) of the lattice, up to its coarsest.
struct ChildLevels {
  Vec3i64 lattice_min{};
  std::uint32_t first_lod = 0;  ///< lattice level of the child's level 0
  std::uint32_t begin = 0;      ///< lattice level of coarse.levels[0]
  CoarseLevels coarse;          ///< empty if the overview duplicates no levels
};

/// Reads only levels `begin` and coarser of the file. begin: a level of the lattice; beyond the shard's coarsest level
/// nothing is read.
/// Errors  InputError: damaged, or `begin` is finer than the shard's finest level.
ChildLevels read_child_levels(const ShardReader& reader, std::uint32_t begin);

/// The window that levels are joined in.
struct DuplicatedWindow {
  Vec3i64 min{};                     ///< lod-0 voxels
  std::uint32_t edge = 0;            ///< lod-0 voxels
  std::uint32_t begin = 0, end = 0;  ///< levels of the lattice
  bool normals = true, facing = true;
};

/// Returns levels [begin, end) of the window.
/// Exact   The children's voxels that lie in the window, at their lattice positions and with their stored values.
///         Bricks are aligned to the window; children need not be.
/// Cost    Sorts bricks, not voxels. A brick is copied whole if its child's bricks are aligned to the window's.
/// Errors  InputError: two children have a voxel at the same position, or a child lacks one of the levels.
std::vector<kernels::Level> joined_levels(std::span<const ChildLevels* const> children, const DuplicatedWindow& window,
                                          const ThreadPool& pool);

}  // namespace gigabake
