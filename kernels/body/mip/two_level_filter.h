/// Filter for one voxel of a coarser level, from the 4×4×4 voxels two levels below it. MipFilter::thesis uses it from
/// level 2. The 64 voxels are an octant of one brick.
///
/// Exact   Integers (colour, coverage) and IEEE double (octahedral encode): host and device return the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/morton.h"
#include "kernels/body/mask.h"
#include "kernels/body/mip/mip.h"
#include "kernels/body/prune/node.h"

namespace gigabake::kernels {

/// Returns the key of the brick two levels above that contains a brick.
GB_HD std::uint64_t grandparent_key(std::uint64_t key) { return parent_key(parent_key(key)); }

/// Returns the voxel that is filtered from an octant of brick `key`, as x + 8y + 64z in the brick two levels above.
GB_HD int grandparent_voxel(std::uint64_t key, int octant) {
  const std::uint32_t code = std::uint32_t(key & 63) << 3 | std::uint32_t(octant);
  return gather_three_bits(code) + 8 * gather_three_bits(code >> 1) + 64 * gather_three_bits(code >> 2);
}

/// Returns the bits of an octant in one mask word. The octant lies in four words, which begin at word 4·(octant / 4).
GB_HD std::uint64_t octant_bits(int octant) { return 0x0f0f0f0full << (4 * (octant & 1) + 32 * (octant >> 1 & 1)); }

/// Returns true if one of an octant's 64 voxels exists. The voxel filtered from them then exists, too.
GB_HD bool has_voxels(const std::uint64_t mask[8], int octant) {
  const std::uint64_t* slab = mask + 4 * (octant >> 2);
  return ((slab[0] | slab[1] | slab[2] | slab[3]) & octant_bits(octant)) != 0;
}

/// Calls visit(i) for each voxel of an octant; i is the voxel's index in the level. `first` is the index of the brick's
/// first voxel.
template <class Visit>
GB_HD void for_each_of_64(const std::uint64_t mask[8], int octant, std::size_t first, const Visit& visit) {
  const int begin = 4 * (octant >> 2);
  std::size_t before = first;
  for (int z = 0; z < begin; ++z) before += std::size_t(bit_count(mask[z]));
  for (int z = begin; z < begin + 4; ++z) {
    for (std::uint64_t rest = mask[z] & octant_bits(octant); rest != 0; rest &= rest - 1)
      visit(before + std::size_t(bit_count(mask[z] & ((rest & (0 - rest)) - 1))));
    before += std::size_t(bit_count(mask[z]));
  }
}

/// Returns the voxel filtered from an octant that has voxels. Colour and normal are means weighted by alpha. Alpha is
/// m^(1 - m), where m is the mean alpha of all 64 voxels and missing voxels have alpha 0. The call voxel(i) returns
/// voxel i of the level.
template <class VoxelAt>
GB_HD Voxel two_level_filter(const std::uint64_t mask[8], int octant, std::size_t first, const VoxelAt& voxel,
                             const Tables& tables) {
  MipSums sums;
  for_each_of_64(mask, octant, first, [&](std::size_t i) {
    const Voxel v = voxel(i);
    sums.add(v, unit_normal_of(v.normal, tables), v.rgba[3], tables);
  });
  return sums.voxel(tables.thesis_alpha[sums.weight], tables);
}

}  // namespace gigabake::kernels
