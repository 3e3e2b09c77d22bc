/// Areas of the classes in the voxels of one brick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/body/voxel_class.h"

namespace gigabake::kernels {

/// The sum of areas per voxel and class, in any order of adding. An object is reused for the next brick.
/// Cost    Memory: 32 bytes per voxel and class, and at most as much again, or for 2^16 fragments.
class ClassAreas {
 public:
  /// `voxel` is x + 8y + 64z. `area` is Fragment::weight.
  void add(int voxel, VoxelClass voxel_class, std::int64_t area) {
    if (areas_.size() >= limit_) compact();
    areas_.push_back({std::uint32_t(voxel) << class_bits | voxel_class, area});
  }
  /// Returns the class of each voxel of the brick, and forgets all areas. Voxels without areas have no class.
  /// Exact   Sums have 128 bits, so any number of fragments is exact.
  std::vector<VoxelClass> take_classes();

 private:
  struct Area {
    std::uint32_t key;  ///< voxel, then class
    __int128 area;
  };
  static constexpr int class_bits = 16;
  static constexpr std::size_t min_limit = std::size_t(1) << 16;

  void compact();

  std::vector<Area> areas_;
  std::size_t limit_ = min_limit;  ///< number of entries from which equal keys are joined
};

}  // namespace gigabake::kernels
