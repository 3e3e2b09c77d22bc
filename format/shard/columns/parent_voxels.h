/// The voxels from which the voxels of a brick are predicted (core/codec/prediction.h).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/codec/prediction.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Returns the parent of each brick, by level; the root has none. Also bricks to which no node refers have none.
/// Range   `bricks` has the number of bricks per lod. The node table may be inconsistent.
std::vector<std::vector<BrickParent>> brick_parents(const NodeTable& nodes, std::span<const std::size_t> bricks);

/// Consecutive bricks of a level. `begin` is the number of the first one in its level. Borrowed; null: no bricks.
struct SomeBricks {
  const BrickLevel* bricks = nullptr;
  std::uint64_t begin = 0;

  bool contains(std::uint64_t brick) const {
    return bricks != nullptr && brick >= begin && brick - begin < bricks->mask.size() / 8;
  }
};

/// Returns which groups of a brick have a parent voxel; bit i is group i.
/// Range   The parent is in `above` if it is a brick.
std::uint64_t groups_with_parent(const BrickParent& parent, const SomeBricks& above);

/// The predictions of a brick's groups, from their parent voxels. A group without parent voxel has zeros.
struct ParentVoxels {
  std::uint64_t there = 0;  ///< groups_with_parent()
  std::array<std::uint32_t, groups_per_brick> rgb = {};
  std::array<std::uint16_t, groups_per_brick> normal = {};
};
/// Range   The parent is in `above` if it is a brick.
ParentVoxels parent_voxels(const BrickParent& parent, const SomeBricks& above);

/// The number of voxels before each word of a brick's mask, for rank_of().
struct WordRanks {
  std::array<std::uint16_t, brick_edge> before;
  std::uint32_t voxels = 0;

  explicit WordRanks(const std::uint64_t* mask) {
    for (std::size_t z = 0; z < before.size(); ++z) {
      before[z] = std::uint16_t(voxels);
      voxels += bits_in(mask[z]);
    }
  }
};

/// The voxels of a brick by Morton code: codes_of_octant() of all octants.
using BrickCodes = std::array<std::uint64_t, octants_a_brick>;
BrickCodes codes_of(const std::uint64_t* mask);

/// voxel_of_code() of all codes.
inline constexpr std::array<std::uint16_t, brick_voxels> voxel_of_codes = [] {
  std::array<std::uint16_t, brick_voxels> voxels{};
  for (unsigned code = 0; code < brick_voxels; ++code) voxels[code] = std::uint16_t(voxel_of_code(code));
  return voxels;
}();

/// Calls visit(group, index) for each voxel of a brick by rising code. `index` counts the brick's voxels in the order
/// of the mask. `codes` is codes_of(mask).
template <class Visit>
void for_each_by_code(const std::uint64_t* mask, const BrickCodes& codes, const Visit& visit) {
  const WordRanks ranks(mask);
  for (unsigned octant = 0; octant < octants_a_brick; ++octant)
    for (std::uint64_t rest = codes[octant]; rest != 0; rest &= rest - 1) {
      const unsigned code = octant << 6 | unsigned(std::countr_zero(rest));
      visit(code >> 3, rank_of(mask, ranks.before.data(), voxel_of_codes[code]));
    }
}

}  // namespace gigabake
