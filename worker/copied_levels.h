/// The coarsest levels of an overview's children, joined in the overview's window: what its shard repeats of theirs, so
/// that a view from afar opens one file instead of many.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/shard/coarse_levels.h"
#include "format/shard/shard_reader.h"
#include "kernels/body/cell.h"
#include "lattice/thread_pool.h"

namespace gigabake {

/// A child's voxels on levels [begin, …) of the lattice, up to its coarsest.
struct ChildLevels {
  std::array<std::int64_t, 3> lattice_min{};
  std::uint32_t first_lod = 0;  ///< lattice level of the child's own level 0
  std::uint32_t begin = 0;      ///< lattice level of coarse.levels[0]
  CoarseLevels coarse;          ///< empty where the overview copies nothing
};

/// Reads only these levels of the file.
/// begin: a level of the lattice; beyond the shard's coarsest one: nothing is read.
/// Errors  InputError: damaged, or the shard has no level `begin`.
ChildLevels read_child_levels(const ShardReader& reader, std::uint32_t begin);

/// The window that levels are joined on.
struct CopyWindow {
  std::array<std::int64_t, 3> min{};  ///< lod-0 voxels
  std::uint32_t edge = 0;             ///< likewise
  std::uint32_t begin = 0, end = 0;   ///< levels of the lattice
  bool normals = true, facing = true;
};

/// Returns levels [begin, end) of the window.
/// Exact   The children's voxels at their places on the lattice, as far as they lie in the window, value by value as
/// the
///         children store them. Bricks are aligned to the window, and children need not be.
/// Cost    Bricks are sorted, not voxels. A brick is copied whole where its child's bricks are aligned to the window's.
/// Errors  InputError: two children have a voxel at one place, or a child lacks one of the levels.
std::vector<kernels::Level> joined_levels(std::span<const ChildLevels* const> children, const CopyWindow& window,
                                          const ThreadPool& pool);

}  // namespace gigabake
