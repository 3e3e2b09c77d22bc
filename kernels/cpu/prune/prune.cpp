#include "kernels/cpu/prune/prune.h"

#include <algorithm>

#include "core/base/thread_pool.h"
#include "core/octree/brick.h"
#include "kernels/body/prune/node.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {
namespace {

/// The classification of a brick, before nodes are numbered.
struct BrickClass {
  NodeKind kind = NodeKind::brick;
  CommonVoxel value;
  bool stored = true;  ///< false below a leaf-constant node
};
using BrickClasses = std::vector<BrickClass>;

/// Returns, for each brick of `level`, the index of its first child in `below`. The last entry is the number of bricks
/// in `below`.
std::vector<std::size_t> child_starts(const Level& level, const Level& below) {
  std::vector<std::size_t> starts;
  std::size_t child = 0;
  for (const std::uint64_t key : level.key) {
    starts.push_back(child);
    while (child < below.key.size() && parent_key(below.key[child]) == key) ++child;
  }
  starts.push_back(child);
  return starts;
}

CommonVoxel voxel_of(const Level& level, std::size_t i) {
  return common_voxel(
      pack_rgba(&level.rgba[4 * i]), level.normal.empty() ? std::uint16_t(0) : pack_normal(&level.normal[2 * i]),
      level.directional_coverage.empty() ? nullptr : &level.directional_coverage[directional_coverage_bytes * i],
      level.voxel_class.empty() ? no_class : level.voxel_class[i]);
}

BrickClass classify_brick(const Level& level, std::size_t b) {
  const std::optional<CommonVoxel> value = common_value(level, b);
  return {kind_of_brick(value.has_value()), value.value_or(CommonVoxel{})};
}

bool branch_is_constant(const BrickClass& parent, const BrickClasses& below, std::size_t begin, std::size_t end) {
  if (end - begin != 8) return false;
  return std::all_of(
      below.begin() + std::ptrdiff_t(begin), below.begin() + std::ptrdiff_t(end),
      [&](const BrickClass& child) { return ends_branch(child.kind) && are_equal(child.value, parent.value); });
}

std::vector<BrickClasses> judge(const std::vector<Level>& levels, const ThreadPool& pool) {
  std::vector<BrickClasses> classes;
  for (std::size_t lod = 0; lod < levels.size(); ++lod) {
    const Level& level = levels[lod];
    const std::vector<std::size_t> children =
        lod == 0 ? std::vector<std::size_t>() : child_starts(level, levels[lod - 1]);
    BrickClasses v(level.key.size());
    pool.parallel_for(v.size(), 256, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t b = begin; b < end; ++b) {
        v[b] = classify_brick(level, b);
        if (!stores_voxels(v[b].kind))
          v[b].kind =
              kind_of_constant(lod == 0 || branch_is_constant(v[b], classes[lod - 1], children[b], children[b + 1]));
      }
    });
    for (std::size_t b = 0; lod > 0 && b < v.size(); ++b)
      if (ends_branch(v[b].kind))
        for (std::size_t c = children[b]; c < children[b + 1]; ++c) classes[lod - 1][c].stored = false;
    classes.push_back(std::move(v));
  }
  return classes;
}

/// Appends the nodes of one level. Sets leaf_mask to all occupied octants; remove_children_from_leaves() completes it.
/// link_children() sets their children after the next finer level is appended.
void add_level_nodes(const Level& level, const BrickClasses& classes, std::size_t lod, NodeTable& nodes) {
  std::uint32_t brick = 0;
  for (std::size_t b = 0; b < classes.size(); ++b) {
    const BrickClass& v = classes[b];
    if (!v.stored) continue;
    append_node(level.key[b], lod, v.kind, v.value, !level.directional_coverage.empty(), !level.voxel_class.empty(),
                brick, nodes);
    const bool may_have_leaves = lod != 0 && !ends_branch(v.kind);
    nodes.leaf_mask.push_back(std::uint8_t(may_have_leaves ? occupied_octants(&level.mask[8 * b]) : 0u));
  }
}

/// Completes leaf_mask: an occupied octant with a stored child is no leaf. Empties it if there are no leaves.
void remove_children_from_leaves(NodeTable& nodes) {
  bool any = false;
  for (std::size_t n = 0; n < nodes.leaf_mask.size(); ++n) {
    nodes.leaf_mask[n] = std::uint8_t(nodes.leaf_mask[n] & ~nodes.child_mask[n]);
    any = any || nodes.leaf_mask[n] != 0;
  }
  if (!any) nodes.leaf_mask = {};
}

void remove_constant_bricks(Level& level, const BrickClasses& classes) {
  if (std::all_of(classes.begin(), classes.end(), [](const BrickClass& v) { return stores_voxels(v.kind); })) return;
  Level kept;
  kept.first.push_back(0);
  for (std::size_t b = 0; b < classes.size(); ++b) {
    if (!stores_voxels(classes[b].kind)) continue;
    const auto first = std::ptrdiff_t(level.first[b]), end = std::ptrdiff_t(level.first[b + 1]);
    kept.key.push_back(level.key[b]);
    kept.mask.insert(kept.mask.end(), &level.mask[8 * b], &level.mask[8 * b] + 8);
    kept.rgba.insert(kept.rgba.end(), level.rgba.begin() + 4 * first, level.rgba.begin() + 4 * end);
    if (!level.normal.empty())
      kept.normal.insert(kept.normal.end(), level.normal.begin() + 2 * first, level.normal.begin() + 2 * end);
    if (!level.directional_coverage.empty())
      kept.directional_coverage.insert(
          kept.directional_coverage.end(),
          level.directional_coverage.begin() + std::ptrdiff_t(directional_coverage_bytes) * first,
          level.directional_coverage.begin() + std::ptrdiff_t(directional_coverage_bytes) * end);
    if (!level.voxel_class.empty())
      kept.voxel_class.insert(kept.voxel_class.end(), level.voxel_class.begin() + first,
                              level.voxel_class.begin() + end);
    kept.first.push_back(kept.rgba.size() / 4);
  }
  level = std::move(kept);
}

NodeTable nodes_of(const std::vector<Level>& levels, const std::vector<BrickClasses>& classes) {
  NodeTable nodes;
  std::size_t above = 0;
  for (std::size_t lod = levels.size(); lod-- > 0;) {
    const std::size_t begin = nodes.key.size();
    add_level_nodes(levels[lod], classes[lod], lod, nodes);
    check_node_count(nodes.key.size());
    if (begin != 0) link_children(nodes, above, begin);  // the root has no parent
    above = begin;
  }
  remove_children_from_leaves(nodes);
  return nodes;
}

}  // namespace

std::optional<CommonVoxel> common_value(const Level& level, std::size_t b) {
  if (!is_full(&level.first[b])) return std::nullopt;
  const std::size_t first = level.first[b];
  const CommonVoxel value = voxel_of(level, first);
  for (std::size_t i = first + 1; i < first + brick_voxels; ++i)
    if (!are_equal(value, voxel_of(level, i))) return std::nullopt;
  return value;
}

void append_node(std::uint64_t key, std::size_t lod, NodeKind kind, const CommonVoxel& voxel, bool has_coverage,
                 bool has_classes, std::uint32_t& brick, NodeTable& nodes) {
  const CommonVoxel value = value_of_node(kind, voxel, has_coverage);
  nodes.key.push_back(key);
  nodes.lod.push_back(std::uint8_t(lod));
  nodes.kind.push_back(kind);
  nodes.child_mask.push_back(0);
  nodes.first_child.push_back(no_child);
  nodes.value.push_back(stores_voxels(kind) ? brick++ : value.rgba);
  nodes.normal.push_back({std::int8_t(byte_of(value.normal, 0)), std::int8_t(byte_of(value.normal, 1))});
  nodes.directional_coverage.push_back({byte_of(value.directional_coverage, 0), byte_of(value.directional_coverage, 1),
                                        byte_of(value.directional_coverage, 2),
                                        byte_of(value.directional_coverage, 3)});
  if (has_classes) nodes.voxel_class.push_back(value.voxel_class);
}

void link_children(NodeTable& nodes, std::size_t begin, std::size_t end) {
  std::size_t parent = begin;
  for (std::size_t child = end; child < nodes.key.size(); ++child) {
    while (nodes.key[parent] != parent_key(nodes.key[child])) ++parent;
    NodeChildren children{nodes.first_child[parent], nodes.child_mask[parent]};
    children.add(std::uint32_t(child), nodes.key[child]);
    nodes.first_child[parent] = children.first;
    nodes.child_mask[parent] = children.mask;
  }
}

NodeTable prune(std::vector<Level>& levels, const ThreadPool& pool) {
  const std::vector<BrickClasses> classes = judge(levels, pool);
  NodeTable nodes = nodes_of(levels, classes);
  nodes.has_finest_planes = !levels.empty() && !levels[0].directional_coverage.empty();
  for (std::size_t lod = 0; lod < levels.size(); ++lod) remove_constant_bricks(levels[lod], classes[lod]);
  return nodes;
}

NodeTable brick_nodes(const std::vector<Level>& levels) {
  std::vector<BrickClasses> all_bricks;
  for (const Level& level : levels) all_bricks.emplace_back(level.key.size());
  return nodes_of(levels, all_bricks);
}

}  // namespace gigabake::kernels
