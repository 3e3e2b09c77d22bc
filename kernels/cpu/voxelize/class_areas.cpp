#include "kernels/cpu/voxelize/class_areas.h"

#include <algorithm>

#include "core/octree/brick.h"

namespace gigabake::kernels {

/// Joins entries of the same voxel and class. The limit stays at least twice the number of entries, so that the time
/// of all calls is that of sorting each fragment a few times.
void ClassAreas::compact() {
  std::ranges::sort(areas_, {}, &Area::key);
  std::size_t count = 0;
  for (const Area& area : areas_) {
    if (count != 0 && areas_[count - 1].key == area.key)
      areas_[count - 1].area += area.area;
    else
      areas_[count++] = area;
  }
  areas_.resize(count);
  limit_ = std::max(min_limit, 2 * count);
}

std::vector<VoxelClass> ClassAreas::take_classes() {
  compact();
  std::vector<VoxelClass> classes(brick_voxels, no_class);
  for (std::size_t i = 0; i < areas_.size();) {
    const std::uint32_t voxel = areas_[i].key >> class_bits;
    ClassMajority<__int128> majority;
    for (; i < areas_.size() && areas_[i].key >> class_bits == voxel; ++i)
      majority.add(VoxelClass(areas_[i].key), areas_[i].area);
    classes[voxel] = majority.voxel_class;
  }
  areas_.clear();
  limit_ = min_limit;
  return classes;
}

}  // namespace gigabake::kernels
