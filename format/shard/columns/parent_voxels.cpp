#include "format/shard/columns/parent_voxels.h"

#include <bit>

namespace gigabake {
namespace {

std::uint16_t two_bytes(const std::int8_t* normal) {
  return std::uint16_t(std::uint8_t(normal[0]) | std::uint8_t(normal[1]) << 8);
}

bool has_equal_columns(const NodeTable& n) {
  const std::size_t rows = n.kind.size();
  return n.lod.size() == rows && n.child_mask.size() == rows && n.first_child.size() == rows &&
         n.value.size() == rows && n.normal.size() == rows;
}

BrickParent parent_of_node(const NodeTable& n, std::size_t row, unsigned octant) {
  const bool is_brick = n.kind[row] == NodeKind::brick;
  return {n.value[row], two_bytes(n.normal[row].data()), is_brick ? BrickParent::brick : BrickParent::constant,
          std::uint8_t(octant)};
}

}  // namespace

BrickCodes codes_of(const std::uint64_t* mask) {
  BrickCodes codes;
  for (unsigned octant = 0; octant < octants_a_brick; ++octant) codes[octant] = codes_of_octant(mask, octant);
  return codes;
}

std::vector<std::vector<BrickParent>> brick_parents(const NodeTable& n, std::span<const std::size_t> bricks) {
  std::vector<std::vector<BrickParent>> parents;
  for (const std::size_t count : bricks) parents.emplace_back(count);
  if (!has_equal_columns(n)) return parents;
  for (std::size_t row = 0; row < n.kind.size(); ++row) {
    std::size_t child = n.first_child[row];
    for (std::uint32_t rest = n.child_mask[row]; rest != 0; rest &= rest - 1, ++child) {
      if (child >= n.kind.size() || n.kind[child] != NodeKind::brick || n.lod[child] >= bricks.size()) continue;
      std::vector<BrickParent>& of_level = parents[n.lod[child]];
      const std::size_t above = std::size_t(n.lod[child]) + 1;
      const bool is_above = n.kind[row] != NodeKind::brick || (above < bricks.size() && n.value[row] < bricks[above]);
      if (n.value[child] < of_level.size() && is_above)
        of_level[n.value[child]] = parent_of_node(n, row, unsigned(std::countr_zero(rest)));
    }
  }
  return parents;
}

std::uint64_t groups_with_parent(const BrickParent& parent, const SomeBricks& above) {
  if (parent.kind != BrickParent::brick) return parent.kind == BrickParent::constant ? ~std::uint64_t(0) : 0;
  return codes_of_octant(&above.bricks->mask[brick_edge * (parent.value - above.begin)], parent.octant);
}

ParentVoxels parent_voxels(const BrickParent& parent, const SomeBricks& above) {
  ParentVoxels out;
  out.there = groups_with_parent(parent, above);
  if (parent.kind == BrickParent::constant) {
    out.rgb.fill(parent.value);
    out.normal.fill(parent.normal);
  }
  if (parent.kind != BrickParent::brick) return out;
  const BrickLevel& level = *above.bricks;
  const std::size_t brick = parent.value - above.begin;
  const std::uint64_t* mask = &level.mask[8 * brick];
  const WordRanks ranks(mask);
  for (std::uint64_t rest = out.there; rest != 0; rest &= rest - 1) {
    const auto group = unsigned(std::countr_zero(rest));
    const std::size_t voxel =
        level.first[brick] + rank_of(mask, ranks.before.data(), voxel_of_codes[parent.octant << 6 | group]);
    const std::uint8_t* rgb = &level.rgba[4 * voxel];
    out.rgb[group] = std::uint32_t(rgb[0] | rgb[1] << 8 | rgb[2] << 16);
    if (!level.normal.empty()) out.normal[group] = two_bytes(&level.normal[2 * voxel]);
  }
  return out;
}

}  // namespace gigabake
