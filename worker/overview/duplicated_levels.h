/// Duplicated levels of an overview: the coarsest levels of its children, joined in the overview's window. The
/// overview's shard stores them again, so that a distant view opens one file instead of many.
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

/// A child's voxels on the lattice levels from `begin` to the child's coarsest level.
struct ChildLevels {
  Vec3i64 lattice_min{};
  std::uint32_t first_lod = 0;  ///< lattice level of the child's level 0
  std::uint32_t begin = 0;      ///< lattice level of coarse.levels[0]
  CoarseLevels coarse;          ///< empty if `begin` is above the child's coarsest level
};

/// Reads only the shard's levels from lattice level `begin` to the coarsest. The result is empty if `begin` is above
/// the shard's coarsest level.
/// Errors  InputError if the shard is damaged, or if `begin` is finer than its finest level.
ChildLevels read_child_levels(const ShardReader& reader, std::uint32_t begin);

/// The cube of the lattice in which levels of several children are joined.
struct DuplicatedWindow {
  Vec3i64 min{};                     ///< lod-0 voxels
  std::uint32_t edge = 0;            ///< lod-0 voxels
  std::uint32_t begin = 0, end = 0;  ///< levels of the lattice
  bool normals = true, directional_coverage = true, classes = false;
};

/// Joins the children's levels [window.begin, window.end) in the window, and returns these levels.
/// Exact   The levels contain the children's voxels inside the window, at their lattice positions and with their stored
///         values. The result's bricks are aligned to the window; the children's bricks need not be.
/// Cost    Sorts bricks, not voxels. A brick is copied whole if its child's bricks are aligned to the window's bricks.
/// Errors  InputError if two children have a voxel at the same position, or if a child lacks one of the levels.
std::vector<kernels::Level> joined_levels(std::span<const ChildLevels* const> children, const DuplicatedWindow& window,
                                          const ThreadPool& pool);

}  // namespace gigabake
