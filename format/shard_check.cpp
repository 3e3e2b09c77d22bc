#include "format/shard_check.h"

#include <bit>
#include <cmath>

#include "format/error.h"

namespace gigabake {
namespace {

constexpr std::uint32_t no_child = 0xffffffffu;

/// Throws for the first row that breaks a rule.
struct Table {
  const std::filesystem::path& path;
  std::string name;
  void expect(bool holds, std::size_t row, const char* rule) const {
    if (!holds) throw InputError(path, name, "row " + std::to_string(row) + ": " + rule);
  }
};

void check_node(const Table& table, const ShardHeader& header, const NodeTable& n, std::size_t i) {
  const std::uint32_t lod = n.lod[i];
  table.expect(lod < header.lods, i, "lod is beyond the cell's");
  table.expect(n.key[i] >> (3 * (header.lods - 1 - lod)) == 0, i, "key is outside the cell");
  table.expect(n.kind[i] <= NodeKind::leaf_constant, i, "kind is unknown");
  if (i == 0) return table.expect(lod + 1 == header.lods, i, "the first node is not the root");
  table.expect(n.lod[i - 1] == lod || n.lod[i - 1] == lod + 1, i, "levels are out of order");
  table.expect(n.lod[i - 1] != lod || n.key[i - 1] < n.key[i], i, "keys are out of Morton order");
}

/// Returns the index after the node's last child.
std::size_t check_children(const Table& table, const NodeTable& n, std::size_t i, std::size_t next) {
  const auto children = std::size_t(std::popcount(n.child_mask[i]));
  if (children == 0) {
    table.expect(n.first_child[i] == no_child, i, "first_child without children");
    table.expect(n.lod[i] == 0 || n.kind[i] == NodeKind::leaf_constant, i, "children are missing");
    return next;
  }
  table.expect(n.kind[i] != NodeKind::leaf_constant && n.lod[i] > 0, i, "a leaf has children");
  table.expect(n.first_child[i] == next && next + children <= n.key.size(), i, "first_child is out of order");
  std::size_t child = next;
  for (std::uint64_t c = 0; c < 8; ++c) {
    if ((n.child_mask[i] >> c & 1) == 0) continue;
    table.expect(n.lod[child] + 1 == n.lod[i] && n.key[child] == (n.key[i] << 3 | c), child,
                 "is not the child its parent says");
    ++child;
  }
  return child;
}

}  // namespace

void check_header(const std::filesystem::path& path, const ShardHeader& h) {
  const Table table{path, "attributes"};
  table.expect(std::has_single_bit(h.cell_voxels) && h.cell_voxels >= 8 && h.cell_voxels <= 8192, 0,
               "cell_voxels is no power of two from 8 to 8192");
  table.expect(h.lods == std::uint32_t(std::bit_width(h.cell_voxels / 8)), 0, "lods does not fit cell_voxels");
  table.expect(h.voxel_size_m > 0 && std::isfinite(h.voxel_size_m), 0, "voxel_size_m is not positive");
  for (int c = 0; c < 3; ++c) {
    table.expect(std::isfinite(h.lattice_origin_m[std::size_t(c)]), 0, "lattice_origin_m is not finite");
    const std::int64_t low = h.lattice_min[std::size_t(c)];
    table.expect(low % 8 == 0 && std::abs(double(low)) <= 0x1p52, 0, "lattice_min is not a multiple of 8 within 2^52");
  }
  table.expect(h.content_hash.size() == h.lods, 0, "content_hash has not one entry a lod");
}

void check_nodes(const std::filesystem::path& path, const ShardHeader& header, const NodeTable& n) {
  const Table table{path, "/nodes"};
  const std::size_t count = n.key.size();
  table.expect(count > 0 && count < no_child, 0, "a shard has 1 to 2^32-2 nodes");
  table.expect(n.lod.size() == count && n.kind.size() == count && n.child_mask.size() == count &&
                   n.first_child.size() == count && n.value.size() == count && n.normal.size() == count,
               0, "columns differ in length");
  for (std::size_t i = 0; i < count; ++i) check_node(table, header, n, i);
  std::size_t next_child = 1;
  std::vector<std::uint32_t> next_brick(header.lods, 0);
  for (std::size_t i = 0; i < count; ++i) {
    next_child = check_children(table, n, i, next_child);
    if (n.kind[i] == NodeKind::brick)
      table.expect(n.value[i] == next_brick[n.lod[i]]++, i, "value is not its level's next brick");
  }
  table.expect(next_child == count, next_child, "has no parent");
}

void check_level(const std::filesystem::path& path, const ShardHeader& header, const BrickLevel& level, int lod,
                 std::uint64_t bricks_of_nodes) {
  const Table table{path, "/lod_" + std::to_string(lod)};
  const std::size_t bricks = level.mask.size() / 8, voxels = level.rgba.size() / 4;
  table.expect(bricks == bricks_of_nodes, bricks, "there are not as many bricks as nodes of this level");
  table.expect(level.first.size() == bricks + 1 && level.first[0] == 0, 0, "first does not fit mask");
  table.expect(level.normal.size() == (header.has_normals ? 2 * voxels : 0), 0, "normal does not fit rgba");
  for (std::size_t b = 0; b < bricks; ++b) {
    std::uint64_t count = 0;
    for (int w = 0; w < 8; ++w) count += std::uint64_t(std::popcount(level.mask[8 * b + std::size_t(w)]));
    table.expect(count > 0 && level.first[b + 1] == level.first[b] + count, b, "first does not count the mask's bits");
  }
  table.expect(level.first[bricks] == voxels, bricks, "first does not end at the number of voxels");
  for (std::size_t v = 0; v < voxels; ++v) table.expect(level.rgba[4 * v + 3] != 0, v, "a voxel without coverage");
}

std::vector<std::uint64_t> brick_counts(const ShardHeader& header, const std::vector<std::uint8_t>& lod,
                                        const std::vector<NodeKind>& kind) {
  std::vector<std::uint64_t> counts(header.lods, 0);
  for (std::size_t i = 0; i < lod.size(); ++i)
    if (kind[i] == NodeKind::brick && lod[i] < header.lods) ++counts[lod[i]];
  return counts;
}

}  // namespace gigabake
