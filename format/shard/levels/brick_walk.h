/// Iteration over every voxel of a shard. Constant nodes are expanded to the voxels that they represent.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "core/octree/morton.h"
#include "format/shard/shard.h"

namespace gigabake {

/// The rows [begin, end) of one level in the node table. The table is sorted by level, from the root down.
struct LevelNodes {
  std::size_t begin = 0, end = 0;
};
std::vector<LevelNodes> level_nodes(const NodeTable& nodes, std::uint32_t lods);

/// Returns the number of voxels per lod, including those that constant nodes represent.
std::vector<std::uint64_t> count_voxels(const Shard& shard);

template <class Visit>
void visit_voxel(const Visit& visit, std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                 const std::int8_t* normal, const std::uint8_t* directional_coverage, VoxelClass voxel_class) {
  if constexpr (std::is_invocable_v<Visit, std::uint32_t, std::uint32_t, std::uint32_t, const std::uint8_t*,
                                    const std::int8_t*, const std::uint8_t*, VoxelClass>)
    visit(x, y, z, rgba, normal, directional_coverage, voxel_class);
  else if constexpr (std::is_invocable_v<Visit, std::uint32_t, std::uint32_t, std::uint32_t, const std::uint8_t*,
                                         const std::int8_t*, const std::uint8_t*>)
    visit(x, y, z, rgba, normal, directional_coverage);
  else
    visit(x, y, z, rgba, normal);
}

/// Calls visit(x, y, z, rgba, normal) for each voxel of one brick. If `visit` accepts a sixth argument, it is
/// `directional_coverage`; a seventh is the class, no_class if the shard has no classes. `at` is the position of the
/// brick, in bricks of the level. `normal` points at two zeros if the shard has no normals; `directional_coverage` is
/// null if the level has no directional coverage.
/// Space   x, y and z are in voxels of the level, relative to the cell's lowest corner.
template <class Visit>
void for_each_voxel(const BrickLevel& level, std::size_t brick, BrickCoordinate at, const Visit& visit) {
  static constexpr std::int8_t no_normal[2] = {0, 0};
  std::size_t i = level.first[brick];
  for (std::uint32_t z = 0; z < 8; ++z)
    for (std::uint64_t rest = level.mask[8 * brick + z]; rest != 0; rest &= rest - 1, ++i) {
      const auto bit = std::uint32_t(std::countr_zero(rest));
      visit_voxel(
          visit, at.x * 8 + (bit & 7), at.y * 8 + (bit >> 3), at.z * 8 + z, &level.rgba[4 * i],
          level.normal.empty() ? no_normal : &level.normal[2 * i],
          level.directional_coverage.empty() ? nullptr : &level.directional_coverage[directional_coverage_bytes * i],
          level.voxel_class.empty() ? no_class : level.voxel_class[i]);
    }
}

/// Returns the directional data of the voxels that a constant node represents; null if they have none. The voxels of
/// level 0 (`is_finest`) have only a plane, which the function stores in `finest`.
inline const std::uint8_t* directional_coverage_of_constant(const NodeTable& nodes, std::size_t node, bool is_finest,
                                                            DirectionalCoverage& finest) {
  if (nodes.directional_coverage.empty() || (is_finest && !nodes.has_finest_planes)) return nullptr;
  const std::uint8_t* stored = nodes.directional_coverage[node].data();
  if (!is_finest) return stored;
  finest = finest_directional_coverage(stored);
  return finest.data();
}

/// Returns the class of the voxels that a constant node represents.
inline VoxelClass class_of_constant(const NodeTable& nodes, std::size_t node) {
  return nodes.voxel_class.empty() ? no_class : nodes.voxel_class[node];
}

/// Visits the voxels that a constant node represents on the level that is `down` levels finer than the node's level.
template <class Visit>
void for_each_constant_voxel(const NodeTable& nodes, std::size_t node, int down, const Visit& visit) {
  const BrickCoordinate at = demorton(nodes.key[node]);
  const std::uint32_t v = nodes.value[node];
  const std::uint8_t rgba[4] = {std::uint8_t(v), std::uint8_t(v >> 8), std::uint8_t(v >> 16), std::uint8_t(v >> 24)};
  DirectionalCoverage finest;
  const std::uint8_t* directional_coverage =
      directional_coverage_of_constant(nodes, node, nodes.lod[node] == down, finest);
  const std::uint32_t edge = 8u << down;
  for (std::uint32_t z = 0; z < edge; ++z)
    for (std::uint32_t y = 0; y < edge; ++y)
      for (std::uint32_t x = 0; x < edge; ++x)
        visit_voxel(visit, at.x * edge + x, at.y * edge + y, at.z * edge + z, rgba, nodes.normal[node].data(),
                    directional_coverage, class_of_constant(nodes, node));
}

/// Visits every voxel of level `lod`. `level` has the bricks of this level.
template <class Visit>
void for_each_voxel_of_level(const NodeTable& nodes, const BrickLevel& level, int lod, const Visit& visit) {
  for (std::size_t n = 0; n < nodes.key.size() && nodes.lod[n] >= lod; ++n) {
    const int down = nodes.lod[n] - lod;
    if (nodes.kind[n] == NodeKind::brick) {
      if (down == 0) for_each_voxel(level, nodes.value[n], demorton(nodes.key[n]), visit);
    } else if (down == 0 || nodes.kind[n] == NodeKind::leaf_constant) {
      for_each_constant_voxel(nodes, n, down, visit);
    }
  }
}

}  // namespace gigabake
