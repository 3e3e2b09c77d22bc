#include "viewer/stream/voxel_arena.h"

#include <utility>

namespace gigabake {

void VoxelArena::take(std::uint32_t slot, std::uint32_t count) {
  taken_[slot] = {end_, count};
  upwards_.push_back({slot, end_});
  end_ += count;
  free_ -= count;
}

void VoxelArena::give_back(std::uint32_t slot) { free_ += std::exchange(taken_[slot], {}).count; }

std::vector<kernels::VoxelMove> VoxelArena::close_gaps() {
  std::vector<kernels::VoxelMove> moves;
  std::vector<Allocation> left;
  end_ = 0;
  for (const Allocation& allocation : upwards_) {
    Taken& taken = taken_[allocation.slot];
    // A slot that was freed and allocated again is listed twice.
    if (taken.count == 0 || taken.first != allocation.first) continue;
    if (end_ != taken.first) moves.push_back({allocation.slot, taken.first, end_, taken.count});
    taken.first = end_;
    left.push_back({allocation.slot, end_});
    end_ += taken.count;
  }
  upwards_ = std::move(left);
  return moves;
}

}  // namespace gigabake
