/// The coarsest levels of a parent's children, joined on the parent's window: what its shard repeats of theirs, so that
/// whoever looks from afar opens one file in place of many.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/shard/shard_reader.h"
#include "kernels/body/cell.h"
#include "lattice/thread_pool.h"

namespace gigabake {

/// A child's voxels on some levels of the lattice.
struct ChildLevels {
  std::array<std::int64_t, 3> lattice_min{};
  std::uint32_t first_lod = 0;  ///< of the child's shard
  NodeTable nodes;
  std::vector<BrickLevel> levels;  ///< of levels begin … end − 1
};

/// Errors  InputError: damaged, or the shard has not all of these levels.
ChildLevels read_child_levels(const ShardReader& reader, std::uint32_t begin, std::uint32_t end);

/// The window that levels are joined on.
struct CopyWindow {
  std::array<std::int64_t, 3> min{};  ///< lod-0 voxels
  std::uint32_t edge = 0;             ///< likewise
  std::uint32_t begin = 0, end = 0;   ///< levels of the lattice
  bool normals = true, facing = true;
};

/// Exact   The children's voxels at their places on the lattice, as far as they lie in the window: value by value what
/// the
///         children store. Bricks stand where the window's do, which may be elsewhere than those of the children.
/// Errors  InputError: two children have a voxel of one place.
std::vector<kernels::Level> joined_levels(std::span<const ChildLevels* const> children, const CopyWindow& window,
                                          const ThreadPool& pool);

}  // namespace gigabake
