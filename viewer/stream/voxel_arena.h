/// The allocator of a segment of the voxel pool. Bricks of any size are stored one after another, with gaps where
/// bricks were freed. A layer of a brick takes the space of one voxel and counts as a voxel. Voxels are allocated at
/// the end. When the end is reached, all bricks move down to close the gaps.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernels/render/caster.h"

namespace gigabake {

class VoxelArena {
 public:
  VoxelArena(std::uint32_t slots, std::uint32_t voxels) : taken_(slots), free_(voxels), size_(voxels) {}

  /// Returns the number of free voxels, including gaps between bricks.
  std::uint32_t free() const { return free_; }
  std::uint32_t size() const { return size_; }

  /// Returns the first voxel of the slot's brick.
  std::uint32_t first(std::uint32_t slot) const { return taken_[slot].first; }

  /// Returns whether `count` voxels fit at the end; if not, call close_gaps() first.
  bool has_room(std::uint32_t count) const { return size_ - end_ >= count; }
  /// Allocates voxels for a slot.
  /// Range   The slot has no voxels, and has_room(count) is true.
  void take(std::uint32_t slot, std::uint32_t count);
  void give_back(std::uint32_t slot);

  /// Compacts the pool: all free voxels are at the end afterwards. Returns the moves in the order that
  /// Caster::move_voxels() requires.
  std::vector<kernels::VoxelMove> close_gaps();

 private:
  struct Taken {
    std::uint32_t first = 0, count = 0;
  };
  struct Allocation {
    std::uint32_t slot, first;
  };

  std::vector<Taken> taken_;         ///< by slot; count 0: free
  std::vector<Allocation> upwards_;  ///< allocations in ascending order; some were freed since the last close_gaps()
  std::uint32_t free_, size_, end_ = 0;
};

}  // namespace gigabake
