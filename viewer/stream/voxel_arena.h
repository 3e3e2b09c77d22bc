/// Who stands where in the pool of voxels: bricks of any size, one behind the other, and gaps where some have gone.
/// What is said of voxels here holds of a brick's layers too, each of which takes the place of one. Voxels are taken at
/// the end; when that is reached what is there moves down, so no gap is ever too small.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernels/cast/caster.h"

namespace gigabake {

class VoxelArena {
 public:
  VoxelArena(std::uint32_t slots, std::uint32_t voxels) : taken_(slots), free_(voxels), size_(voxels) {}

  /// Voxels that nobody has, gaps between others counted.
  std::uint32_t free() const { return free_; }
  std::uint32_t size() const { return size_; }

  /// Where the slot's voxels stand now.
  std::uint32_t first(std::uint32_t slot) const { return taken_[slot].first; }

  /// Whether that many fit behind all others: else close_gaps() comes first.
  bool has_room(std::uint32_t count) const { return size_ - end_ >= count; }
  /// Range  the slot has none; has_room(count).
  void take(std::uint32_t slot, std::uint32_t count);
  void give_back(std::uint32_t slot);

  /// How bricks move, in the order that Caster::move_voxels() wants; afterwards all that is free is at the end.
  std::vector<kernels::VoxelMove> close_gaps();

 private:
  struct Taken {
    std::uint32_t first = 0, count = 0;
  };
  struct Order {
    std::uint32_t slot, first;
  };

  std::vector<Taken> taken_;    ///< by slot; count 0: nothing
  std::vector<Order> upwards_;  ///< what was taken since gaps were closed; some has gone since
  std::uint32_t free_, size_, end_ = 0;
};

}  // namespace gigabake
