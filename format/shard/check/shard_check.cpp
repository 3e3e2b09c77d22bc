#include "format/shard/check/shard_check.h"

#include <bit>
#include <cmath>

#include "format/shard/check/broken_rule.h"
#include "format/shard/check/node_walk.h"

namespace gigabake {
namespace {

constexpr const char* no_plane = "plane is neither 0 nor 5 to 63 with its lowest two bits not 0";

std::string level_name(int lod) { return "/lod_" + std::to_string(lod); }

void check_key(const BrokenRule& table, const ShardHeader& header, const NodeTable& n, std::size_t i) {
  const std::uint32_t lod = n.lod[i];
  table.expect(n.key[i] >> (3 * (header.lods - 1 - lod)) == 0, i, "key is outside the cell");
  table.expect(i == 0 || n.lod[i - 1] != lod || n.key[i - 1] < n.key[i], i, "keys are out of Morton order");
}

void check_keys_of_children(const BrokenRule& table, const NodeTable& n, std::size_t i) {
  std::size_t child = n.first_child[i];
  for (std::uint64_t c = 0; c < 8; ++c) {
    if ((n.child_mask[i] >> c & 1) == 0) continue;
    table.expect(n.key[child] == (n.key[i] << 3 | c), child, "is not the child that its parent refers to");
    ++child;
  }
}

}  // namespace

void check_header(const std::filesystem::path& path, const ShardHeader& h) {
  const BrokenRule table{path, "attributes"};
  table.expect(h.first_lod < 32, 0, "first_lod is not a level of a lattice");
  const std::uint32_t edge = h.cell_voxels >> h.first_lod;
  table.expect(std::has_single_bit(h.cell_voxels) && edge >= 8 && edge <= 8192, 0,
               "cell_voxels is not a power of two from 8 to 8192 voxels of the first level");
  table.expect(h.lods == std::uint32_t(std::bit_width(edge / 8)), 0, "lods does not match cell_voxels");
  table.expect(h.copied_lods < h.lods && (h.first_lod != 0 || h.copied_lods == 0), 0,
               "copied_lods is not less than lods, or not 0 for a cell");
  table.expect(h.voxel_size_m > 0 && std::isfinite(h.voxel_size_m), 0, "voxel_size_m is not positive");
  for (int c = 0; c < 3; ++c) {
    table.expect(std::isfinite(h.lattice_origin_m[std::size_t(c)]), 0, "lattice_origin_m is not finite");
    const std::int64_t low = h.lattice_min[std::size_t(c)];
    table.expect(low % 8 == 0 && std::abs(double(low)) <= 0x1p52, 0, "lattice_min is not a multiple of 8 within 2^52");
    table.expect(h.first_lod == 0 || low % (std::int64_t(h.cell_voxels) / 8) == 0, 0,
                 "lattice_min of an overview is not a multiple of a voxel of its coarsest level");
  }
  table.expect(h.leaf_lod == 0 || (h.leaf_lod > h.first_lod && h.leaf_lod < h.first_lod + h.lods), 0,
               "leaf_lod is not a level above the shard's finest level");
  table.expect(h.content_hash.size() == h.lods, 0, "content_hash does not have one entry per lod");
}

void check_nodes(const std::filesystem::path& path, const ShardHeader& header, const NodeTable& n) {
  const BrokenRule table{path, "/nodes"};
  const std::size_t count = n.key.size();
  table.expect(n.lod.size() == count && n.kind.size() == count && n.child_mask.size() == count &&
                   n.first_child.size() == count && n.value.size() == count && n.normal.size() == count &&
                   n.directional_coverage.size() == (header.has_directional_coverage ? count : 0) &&
                   n.leaf_mask.size() == (header.leaf_lod != 0 ? count : 0) &&
                   n.voxel_class.size() == (header.has_classes ? count : 0),
               0, "columns differ in length");
  NodeWalk walk(path, header, count);
  for (std::size_t i = 0; i < count; ++i) {
    table.expect(header.first_lod == 0 || n.kind[i] == NodeKind::brick, i, "is a constant node of an overview");
    walk.check_links(n.kind[i], n.child_mask[i], n.first_child[i], n.value[i]);
    table.expect(n.voxel_class.empty() || n.kind[i] != NodeKind::brick || n.voxel_class[i] == no_class, i,
                 "a brick has a class");
    walk.step(n.lod[i], n.kind[i], n.child_mask[i], n.leaf_mask.empty() ? std::uint8_t(0) : n.leaf_mask[i]);
    check_key(table, header, n, i);
  }
  for (std::size_t i = 0; i < count; ++i) check_keys_of_children(table, n, i);
  check_planes_of_nodes(path, 0, n.directional_coverage);
}

void check_leaves(const std::filesystem::path& path, const NodeTable& n, const std::vector<BrickLevel>& levels) {
  const BrokenRule table{path, "/nodes"};
  for (std::size_t i = 0; i < n.leaf_mask.size(); ++i) {
    if (n.lod[i] == 0 || n.kind[i] == NodeKind::leaf_constant) continue;
    const unsigned octants = n.kind[i] == NodeKind::brick
                                 ? occupied_octants(&levels.at(n.lod[i]).mask.at(brick_edge * std::size_t(n.value[i])))
                                 : 255u;
    table.expect(octants == unsigned(n.child_mask[i] | n.leaf_mask[i]), i,
                 "an octant with voxels is neither a leaf nor stored, or an empty one is");
  }
}

void check_bricks_of_level(const std::filesystem::path& path, const BrickLevel& level, int lod,
                           std::uint64_t bricks_of_nodes) {
  const BrokenRule table{path, level_name(lod)};
  const std::size_t bricks = level.mask.size() / 8;
  table.expect(bricks == bricks_of_nodes, bricks, "the number of bricks differs from the nodes of this level");
  table.expect(level.first.size() == bricks + 1 && level.first[0] == 0, 0, "first does not match mask");
  check_bricks(path, lod, 0, level.mask, level.first);
}

std::vector<std::uint64_t> brick_counts(const ShardHeader& header, const std::vector<std::uint8_t>& lod,
                                        const std::vector<NodeKind>& kind) {
  std::vector<std::uint64_t> counts(header.lods, 0);
  for (std::size_t i = 0; i < lod.size(); ++i)
    if (kind[i] == NodeKind::brick && lod[i] < header.lods) ++counts[lod[i]];
  return counts;
}

void check_bricks(const std::filesystem::path& path, int lod, std::uint64_t first_brick,
                  std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first) {
  const BrokenRule table{path, level_name(lod)};
  for (std::size_t b = 0; b + 1 < first.size(); ++b) {
    std::uint64_t count = 0;
    for (const std::uint64_t word : mask.subspan(8 * b, 8)) count += std::uint64_t(std::popcount(word));
    table.expect(count > 0 && first[b + 1] == first[b] + count, first_brick + b,
                 "first does not count the mask's bits");
  }
}

void check_coverage(const std::filesystem::path& path, int lod, std::uint64_t first_voxel,
                    std::span<const std::uint8_t> rgba) {
  const BrokenRule table{path, level_name(lod)};
  for (std::size_t v = 0; 4 * v < rgba.size(); ++v)
    table.expect(rgba[4 * v + 3] != 0, first_voxel + v, "a voxel without coverage");
}

void check_planes(const std::filesystem::path& path, int lod, std::uint64_t first_voxel,
                  std::span<const std::uint8_t> directional_coverage) {
  const BrokenRule table{path, level_name(lod)};
  for (std::size_t v = 0; directional_coverage_bytes * v < directional_coverage.size(); ++v)
    table.expect(is_plane(directional_coverage[directional_coverage_bytes * v + directional_coverage_plane]),
                 first_voxel + v, no_plane);
}

void check_planes_of_nodes(const std::filesystem::path& path, std::uint64_t first_node,
                           std::span<const DirectionalCoverage> directional_coverage) {
  const BrokenRule table{path, "/nodes"};
  for (std::size_t i = 0; i < directional_coverage.size(); ++i)
    table.expect(is_plane(directional_coverage[i][directional_coverage_plane]), first_node + i, no_plane);
}

}  // namespace gigabake
