/// Packed bricks as one task makes them, and their concatenation into a level.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/body/voxel.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Consecutive bricks of a level in Morton order; voxels by rising bit number, brick after brick.
class BrickRun {
 public:
  explicit BrickRun(bool normals = true) : normals_(normals) {}

  void push_voxel(const Voxel& v) {
    rgba_.insert(rgba_.end(), v.rgba, v.rgba + 4);
    if (normals_) normal_.insert(normal_.end(), v.normal, v.normal + 2);
  }
  /// Of the voxel pushed last; of all voxels or of none.
  void push_facing(const Facing& facing) { facing_.insert(facing_.end(), facing.begin(), facing.end()); }
  /// Closes the brick whose voxels were pushed since the last call.
  void push_brick(std::uint64_t key, const std::uint64_t mask[8]) {
    key_.push_back(key);
    mask_.insert(mask_.end(), mask, mask + 8);
  }
  std::size_t voxels() const { return rgba_.size() / 4; }
  std::size_t bricks() const { return key_.size(); }

  friend void append(Level& level, std::vector<BrickRun>& runs, const ThreadPool& pool);

 private:
  bool normals_;
  std::vector<std::uint64_t> key_, mask_;
  std::vector<std::uint8_t> rgba_;
  std::vector<std::int8_t> normal_;
  std::vector<std::uint8_t> facing_;
};

/// Moves the runs' bricks, in order, to the level's end; frees the runs.
void append(Level& level, std::vector<BrickRun>& runs, const ThreadPool& pool);

}  // namespace gigabake::kernels
