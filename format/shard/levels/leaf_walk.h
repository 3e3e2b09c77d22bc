/// Visits the leaves of a shard: octants whose voxels describe all finer levels (NodeTable::leaf_mask).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/math/vec3.h"
#include "core/octree/morton.h"
#include "core/octree/octree.h"

namespace gigabake {

/// An octant of leaves: 4×4×4 voxels, of which some exist. Borrowed.
struct LeafVoxels {
  int lod = 0;          ///< level of its voxels, counted from the shard's level 0
  Vec3i64 octant{};     ///< its position in octants of its level from the shard's corner
  unsigned number = 0;  ///< the octant's number in its brick, x | y<<1 | z<<2
  const NodeTable* nodes = nullptr;
  std::size_t node = 0;
  const BrickLevel* level = nullptr;
};

/// Calls visit(LeafVoxels) for each octant of leaves on a level above `lod`, in the order of the nodes. `levels` are
/// the shard's levels from `lod` on.
template <class Visit>
void for_each_leaf_octant(const NodeTable& nodes, const std::vector<BrickLevel>& levels, int lod, const Visit& visit) {
  for (std::size_t n = 0; n < nodes.leaf_mask.size() && nodes.lod[n] > lod; ++n)
    for (unsigned rest = nodes.leaf_mask[n]; rest != 0; rest &= rest - 1) {
      const auto number = unsigned(std::countr_zero(rest));
      const Vec3i64 octant = static_cast<Vec3i64>(demorton(nodes.key[n] << 3 | number));
      visit(LeafVoxels{int(nodes.lod[n]), octant, number, &nodes, n, &levels.at(std::size_t(nodes.lod[n] - lod))});
    }
}

/// Calls visit(position in the octant, rgba, normal, directional coverage) for each voxel of an octant of leaves.
/// Normal is zero, and directional coverage null, if the shard has none.
template <class Visit>
void for_each_leaf(const LeafVoxels& leaves, const Visit& visit) {
  static constexpr std::int8_t no_normal[2] = {0, 0};
  const NodeTable& nodes = *leaves.nodes;
  const BrickLevel& level = *leaves.level;
  const bool is_brick = nodes.kind[leaves.node] == NodeKind::brick;
  const std::size_t brick = is_brick ? nodes.value[leaves.node] : 0;
  const std::uint32_t value = nodes.value[leaves.node];
  const std::array<std::uint8_t, 4> constant = {std::uint8_t(value), std::uint8_t(value >> 8),
                                                std::uint8_t(value >> 16), std::uint8_t(value >> 24)};
  std::size_t voxel = is_brick ? level.first.at(brick) : 0;
  for (unsigned z = 0; z < brick_edge; ++z) {
    const std::uint64_t exists = is_brick ? level.mask.at(brick_edge * brick + z) : ~std::uint64_t(0);
    for (std::uint64_t rest = exists; rest != 0; rest &= rest - 1, ++voxel) {
      const int bit = std::countr_zero(rest);
      if ((octant_word(1u << leaves.number, z) >> bit & 1) == 0) continue;
      const Vec3<int> at{bit & 3, bit >> 3 & 3, int(z) & 3};
      if (is_brick)
        visit(at, &level.rgba[4 * voxel], level.normal.empty() ? no_normal : &level.normal[2 * voxel],
              level.directional_coverage.empty() ? nullptr
                                                 : &level.directional_coverage[directional_coverage_bytes * voxel]);
      else
        visit(at, constant.data(), nodes.normal[leaves.node].data(),
              nodes.directional_coverage.empty() ? nullptr : nodes.directional_coverage[leaves.node].data());
    }
  }
}

}  // namespace gigabake
