/// The bricks of all levels that edits of a stored cell change.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/octree/downsample_state.h"
#include "kernels/body/cell.h"
#include "worker/edit/cell_edits.h"
#include "worker/edit/stored_bricks.h"

namespace gigabake {

/// The bricks of a level that have a changed voxel of lod 0 below them.
struct EditedLevel {
  std::vector<std::uint64_t> keys;  ///< ascending; also bricks without voxels before or after
  kernels::Level before, after;     ///< those with voxels
};

struct EditedLevels {
  std::vector<EditedLevel> levels;  ///< [lod]
  DownsampleState above;            ///< of the whole cell
};

/// The cubes of a cell that are computed again. A cube is a voxel of the coarsest level that edits may change, but at
/// least a brick of lod 0. A voxel depends only on the voxels of lod 0 below it, so a cube depends on no other cube.
class EditedCubes {
 public:
  /// `bricks` has the first brick of each block that edits may change, ascending.
  EditedCubes(std::uint32_t lods, std::span<const std::uint64_t> bricks);

  /// Returns the bricks of lod 0 in the cubes as ranges of keys, ascending.
  struct Range {
    std::uint64_t first, end;
  };
  std::vector<Range> ranges() const;
  /// Returns true if a brick of this level is inside one cube, or outside of all.
  bool contains_whole_bricks(int lod) const { return lod <= level_; }
  /// Returns true if a voxel of level `lod` at `voxel` is inside a cube.
  bool contains(int lod, const Vec3<std::uint32_t>& voxel) const;

 private:
  int level_;  ///< the level on which a cube is a brick
  std::vector<std::uint64_t> cubes_;
};

/// Applies edits to the stored voxels of lod 0, and computes the bricks above the changed ones.
/// Exact   Equals a bake with the edits.
/// Range   The shard comes from a bake with max_error 0. `parameters` describe the cell; parameters.kept is applied.
/// Cost    Reads and filters the voxels of the cubes.
/// Errors  InputError: the shard is damaged.
EditedLevels edited_levels(const BaseShard& base, const StoredBricks& stored, const EditedCubes& cubes,
                           const CellEdits& edits, const kernels::CellParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake
