/// The accumulators of one brick while a thread walks its triangles.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "kernels/body/accumulate.h"
#include "kernels/body/resolve.h"
#include "kernels/cpu/brick_run.h"
#include "lattice/brick.h"

namespace gigabake::kernels {

/// Dense 64-bit sums; after every `fragments_before_flush` triangles they move to 128-bit ones, so that any number of
/// triangles in one voxel is exact. Reused from brick to brick: it is all zero between them.
class BrickSums {
 public:
  BrickSums();

  void add(int voxel, const Fragment& fragment) {
    accumulate(narrow_[voxel].data(), fragment);
    mask_[voxel >> 6] |= std::uint64_t(1) << (voxel & 63);
  }

  /// Call after each triangle: a triangle adds at most one fragment a voxel.
  void end_triangle() {
    if (++triangles_ == fragments_before_flush) flush();
  }

  /// Writes the brick's voxels to `run` (nothing if none is visible) and returns to zero.
  void resolve_to(BrickRun& run, std::uint64_t key, const Tables& tables);

 private:
  using Narrow = std::array<std::int64_t, sum_count>;
  using Wide = std::array<__int128, sum_count>;

  void flush();

  std::unique_ptr<std::array<Narrow, brick_voxels>> narrow_store_;
  std::array<Narrow, brick_voxels>& narrow_;
  std::unique_ptr<std::array<Wide, brick_voxels>> wide_;  ///< made when the first brick needs it
  std::uint64_t mask_[8] = {};
  int triangles_ = 0;
  bool flushed_ = false;
};

}  // namespace gigabake::kernels
