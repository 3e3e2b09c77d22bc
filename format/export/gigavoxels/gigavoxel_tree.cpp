#include "format/export/gigavoxels/gigavoxel_tree.h"

#include <bit>
#include <cmath>

#include "core/base/error.h"
#include "core/math/octahedral.h"

namespace gigabake {
namespace {

constexpr std::uint32_t max_blocks = 1u << 30;

GigavoxelNode node_of(const NodeTable& nodes, std::size_t n, bool normals) {
  const bool constant = nodes.kind[n] != NodeKind::brick;
  return {constant, 0, nodes.value[n], constant && normals ? gradient_bytes(nodes.normal[n].data()) : no_gradient};
}

GigavoxelHeader header_of(const ShardHeader& cell, int lod) {
  GigavoxelHeader h;
  h.max_depth = cell.lods - std::uint32_t(lod);
  h.corner_m = cell.lattice_origin_m + Vec3d(cell.lattice_min) * cell.voxel_size_m;
  h.delta_m = Vec3d::all(std::ldexp(cell.voxel_size_m, int(cell.first_lod) + lod));
  h.volume = Vec3<std::uint32_t>::all(cell.cell_voxels >> (int(cell.first_lod) + lod));
  h.brick = Vec3<std::uint32_t>::all(brick_edge);
  return h;
}

}  // namespace

GradientBytes gradient_bytes(const std::int8_t oct[2]) {
  const auto n = Vec3d(unit_normal(oct));
  GradientBytes bytes;
  for (std::size_t c = 0; c < 3; ++c) bytes[c] = std::uint8_t(std::floor((n[c] + 1) * 127.5 + 0.5));
  return bytes;
}

GigavoxelTree gigavoxel_tree(const ShardHeader& cell, const NodeTable& nodes, int lod) {
  GigavoxelTree tree{header_of(cell, lod), std::vector<GigavoxelNode>(8)};
  tree.nodes[0] = node_of(nodes, 0, cell.has_normals);
  // Rows are breadth first, so a parent's position is known before its children are processed.
  std::vector<std::uint32_t> place(nodes.key.size(), 0);
  for (std::size_t n = 0; n < nodes.key.size() && nodes.lod[n] > lod; ++n) {
    if (nodes.child_mask[n] == 0) continue;
    const std::size_t block = tree.nodes.size() / 8;
    if (block >= max_blocks) throw InputError(cell.cell, "", "has more oct-tree nodes than the format can number");
    tree.nodes[place[n]].child_block = std::uint32_t(block);
    tree.nodes.resize(tree.nodes.size() + 8);
    std::uint32_t row = nodes.first_child[n];
    for (unsigned rest = nodes.child_mask[n]; rest != 0; rest &= rest - 1, ++row) {
      place[row] = std::uint32_t(8 * block + std::size_t(std::countr_zero(rest)));
      tree.nodes[place[row]] = node_of(nodes, row, cell.has_normals);
    }
  }
  return tree;
}

}  // namespace gigabake
