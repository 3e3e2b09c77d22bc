/// The accumulators of one brick, used by one thread for all triangles of the brick.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/octree/brick.h"
#include "kernels/body/voxelize/accumulate.h"
#include "kernels/body/voxelize/resolve.h"
#include "kernels/cpu/voxelize/brick_run.h"
#include "kernels/cpu/voxelize/class_areas.h"

namespace gigabake::kernels {

/// Dense 64-bit sums per voxel. After every `fragments_before_flush` triangles they are added to 128-bit sums, so any
/// number of triangles per voxel is exact. An object is reused for the next brick; all sums are zero between bricks.
class BrickSums {
 public:
  /// `classes` states whether resolve_to() also writes the classes of the voxels.
  explicit BrickSums(bool classes = false);

  void add(int voxel, const Fragment& fragment) {
    accumulate(narrow_[voxel].data(), fragment);
    mask_[voxel >> 6] |= std::uint64_t(1) << (voxel & 63);
    if (areas_ && class_of_triangle_ && has_class_weight(fragment.alpha))
      areas_->add(voxel, *class_of_triangle_, fragment.weight);
  }

  /// Sets the class of the next triangle's fragments. Without one, the caller adds their areas with add_area().
  void begin_triangle(std::optional<VoxelClass> voxel_class) { class_of_triangle_ = voxel_class; }

  /// Adds to the area of a class. `area` is part of Fragment::weight.
  /// Range   resolve_to() writes classes.
  void add_area(int voxel, VoxelClass voxel_class, std::int64_t area) { areas_->add(voxel, voxel_class, area); }

  /// Ends a triangle. Call it after the last fragment of each triangle.
  /// Range   A triangle adds at most one fragment per voxel.
  void end_triangle() {
    if (++triangles_ == fragments_before_flush) flush();
  }

  /// Writes the brick's voxels to `run` (no brick if no voxel is visible) and resets all sums to zero.
  void resolve_to(BrickRun& run, std::uint64_t key, const Tables& tables);

 private:
  using Narrow = std::array<std::int64_t, sum_count>;
  using Wide = std::array<__int128, sum_count>;

  void flush();

  std::unique_ptr<std::array<Narrow, brick_voxels>> narrow_store_;
  std::array<Narrow, brick_voxels>& narrow_;
  std::unique_ptr<std::array<Wide, brick_voxels>> wide_;  ///< allocated by the first flush
  std::optional<ClassAreas> areas_;                       ///< only with classes
  std::optional<VoxelClass> class_of_triangle_ = no_class;
  std::uint64_t mask_[8] = {};
  int triangles_ = 0;
  bool flushed_ = false;
};

}  // namespace gigabake::kernels
