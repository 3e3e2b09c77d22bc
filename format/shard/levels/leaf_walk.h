/// Visits the leaves of a shard: octants whose voxels describe all finer levels (NodeTable::leaf_mask).
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/math/vec3.h"
#include "core/octree/morton.h"
#include "core/octree/octree.h"
#include "core/octree/plane_in_part.h"
#include "format/shard/levels/brick_walk.h"

namespace gigabake {

/// The voxels that leaves describe on finer levels.
enum class LeafShape : std::uint8_t {
  cube,  ///< all voxels of its cube
  plane  ///< only voxels that its plane crosses, if is_cut(); otherwise its cube
};

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
/// the shard's levels from `first_lod` on, which is at most lod + 1.
template <class Visit>
void for_each_leaf_octant(const NodeTable& nodes, const std::vector<BrickLevel>& levels, int first_lod, int lod,
                          const Visit& visit) {
  for (std::size_t n = 0; n < nodes.leaf_mask.size() && nodes.lod[n] > lod; ++n)
    for (unsigned rest = nodes.leaf_mask[n]; rest != 0; rest &= rest - 1) {
      const auto number = unsigned(std::countr_zero(rest));
      const Vec3i64 octant = static_cast<Vec3i64>(demorton(nodes.key[n] << 3 | number));
      visit(
          LeafVoxels{int(nodes.lod[n]), octant, number, &nodes, n, &levels.at(std::size_t(nodes.lod[n] - first_lod))});
    }
}

/// Calls visit(position in the octant, rgba, normal, directional coverage, class) for each voxel of an octant of
/// leaves. Normal is zero, and directional coverage null, if the shard has none.
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
                                                 : &level.directional_coverage[directional_coverage_bytes * voxel],
              level.voxel_class.empty() ? no_class : level.voxel_class[voxel]);
      else
        visit(at, constant.data(), nodes.normal[leaves.node].data(),
              nodes.directional_coverage.empty() ? nullptr : nodes.directional_coverage[leaves.node].data(),
              class_of_constant(nodes, leaves.node));
    }
  }
}

/// Returns whether a leaf describes only some voxels of its cube `finer` levels below it. `plane` is its stored plane;
/// 0 if it has none.
inline bool is_cut(LeafShape shape, int finer, std::uint8_t plane) {
  return shape == LeafShape::plane && finer <= max_ended_lod && is_fully_planar(plane);
}

/// The voxels of a column of a leaf that the leaf's plane crosses, from `low` to before `end`.
struct CrossedColumn {
  int low = 0, end = 0;
};

/// Returns the crossed voxels of a column along the normal's largest axis. `height` is the height of the plane at the
/// column's centre, and `reach` the difference to its extremes in the column, in voxels from the leaf's lower face. A
/// plane on a face belongs to the upper voxel. A plane that passes the leaf at a distance of at most one voxel counts
/// for the nearest voxel, because planes of adjacent leaves differ by the error bound, and no hole may be between them.
inline CrossedColumn crossed_column(double height, double reach, int edge) {
  if (!(height >= -1 && height <= edge + 1)) return {};
  const double low = std::floor(height - reach), high = std::ceil(height + reach);
  const int from = int(low < 0 ? 0 : (low > edge - 1 ? edge - 1 : low)), to = int(high > edge ? edge : high);
  return {from, to > from ? to : from + 1};
}

/// Calls visit(position in the leaf, plane) for each voxel `finer` levels below a leaf that the leaf's plane crosses.
/// Range   is_cut().
template <class Visit>
void for_each_crossed(const std::int8_t normal[2], std::uint8_t plane, int finer, const Visit& visit) {
  const OctahedronPoint point = octahedron_point(normal);
  const Vec3<std::int32_t>& n = point.c;
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(n[a]) > std::abs(n[axis])) axis = a;
  const std::size_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  const int edge = 1 << finer;
  const double reach = 0.5 * (std::abs(n[u]) + std::abs(n[v])) / std::abs(n[axis]);
  for (int column = 0; column < edge * edge; ++column) {
    Vec3<int> at{};
    at[u] = column & (edge - 1);
    at[v] = column >> finer;
    const double across = n[u] * (at[u] + 0.5 - 0.5 * edge) + n[v] * (at[v] + 0.5 - 0.5 * edge);
    const double offset = 127.0 * unpack_plane(plane).offset * edge / (2 * max_offset);
    const CrossedColumn crossed = crossed_column((offset - across) / n[axis] + 0.5 * edge, reach, edge);
    for (int z = crossed.low; z < crossed.end; ++z) {
      at[axis] = z;
      visit(at, nearest_plane(offset_in_part(plane, n, static_cast<Vec3i64>(at), finer)));
    }
  }
}

}  // namespace gigabake
