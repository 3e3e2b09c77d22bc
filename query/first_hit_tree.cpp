#include "query/first_hit_tree.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "core/octree/morton.h"

namespace gigabake {
namespace {

using kernels::FirstHitNode;

constexpr std::uint64_t every_child = ~std::uint64_t(0);

template <class Position>
std::uint64_t key_of(const Position& at) {
  return morton_by_pairs(std::uint32_t(at[0]), std::uint32_t(at[1]), std::uint32_t(at[2]));
}

/// The position of a node, and the mask of its children.
struct PlacedMask {
  std::array<std::int32_t, 3> at;
  std::uint64_t mask;
};

/// Appends the nodes of level `requested` below node `index`, which has level `level` and position `at`.
void collect_level(const std::vector<FirstHitNode>& nodes, std::size_t index, int level, int requested,
                   const std::array<std::int32_t, 3>& at, std::vector<PlacedMask>& out) {
  const FirstHitNode& node = nodes[index];
  if (level == requested) {
    out.push_back({at, node.mask});
    return;
  }
  std::size_t child = node.end - std::size_t(std::popcount(node.mask));
  for (std::uint64_t rest = node.mask; rest != 0; rest &= rest - 1) {
    const int c = std::countr_zero(rest);
    collect_level(nodes, child++, level - 1, requested,
                  {at[0] * 4 + (c & 3), at[1] * 4 + (c >> 2 & 3), at[2] * 4 + (c >> 4)}, out);
  }
}

/// Merges the masks of equal positions.
void merge(std::vector<PlacedMask>& masks) {
  std::sort(masks.begin(), masks.end(), [](const PlacedMask& a, const PlacedMask& b) { return a.at < b.at; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (kept > 0 && masks[kept - 1].at == masks[i].at)
      masks[kept - 1].mask |= masks[i].mask;
    else
      masks[kept++] = masks[i];
  }
  masks.resize(kept);
}

/// Adds each child's two neighbours along one axis.
std::vector<PlacedMask> with_neighbours(const std::vector<PlacedMask>& masks, std::size_t axis) {
  constexpr std::uint64_t lowest[3] = {0x1111111111111111u, 0x000f000f000f000fu, 0x000000000000ffffu};
  const int step = 1 << 2 * axis;
  const std::uint64_t low = lowest[axis], high = low << 3 * step;
  std::vector<PlacedMask> out;
  for (const PlacedMask& m : masks) {
    out.push_back({m.at, m.mask | (m.mask & ~high) << step | (m.mask & ~low) >> step});
    PlacedMask above{m.at, (m.mask & high) >> 3 * step}, below{m.at, (m.mask & low) << 3 * step};
    ++above.at[axis];
    --below.at[axis];
    if (above.mask != 0) out.push_back(above);
    if (below.mask != 0) out.push_back(below);
  }
  merge(out);
  return out;
}

}  // namespace

FirstHitTreeBuilder::FirstHitTreeBuilder(int bits) : levels_(std::size_t(bits / 2)), nodes_(1) {}

void FirstHitTreeBuilder::add(const std::array<std::int32_t, 3>& at, const FirstHitNode& node) {
  levels_[0].push_back({key_of(at), node});
}

void FirstHitTreeBuilder::add_constant(const Position& low, const Position& high, std::uint32_t attributes_index) {
  fill({0, 0, 0}, levels_.size(), low, high, attributes_index);
}

/// Fills the part of a cube inside [low, high). `at` is the cube's lowest corner; the cube's edge is 4^level voxels.
void FirstHitTreeBuilder::fill(const Position& at, std::size_t level, const Position& low, const Position& high,
                               std::uint32_t attributes_index) {
  const std::int64_t edge = std::int64_t(1) << 2 * level;
  bool inside = true;
  for (std::size_t a = 0; a < 3; ++a) {
    if (at[a] >= high[a] || at[a] + edge <= low[a]) return;
    inside = inside && at[a] >= low[a] && at[a] + edge <= high[a];
  }
  if (inside) {
    levels_[level - 1].push_back({key_of(at / edge), full_node(level, attributes_index)});
    return;
  }
  for (int c = 0; c < 64; ++c)
    fill({at[0] + (c & 3) * edge / 4, at[1] + (c >> 2 & 3) * edge / 4, at[2] + (c >> 4) * edge / 4}, level - 1, low,
         high, attributes_index);
}

/// Returns a full node with an edge of 4^level voxels.
FirstHitNode FirstHitTreeBuilder::full_node(std::size_t level, std::uint32_t attributes_index) {
  if (level == 1) return {every_child, attributes_index + 64, 0};
  const auto found = full_children_.find({attributes_index, level});
  if (found != full_children_.end()) return {every_child, found->second + 64, 0};
  const FirstHitNode child = full_node(level - 1, attributes_index);
  const auto first = std::uint32_t(nodes_.size());
  nodes_.insert(nodes_.end(), 64, child);
  full_children_[{attributes_index, level}] = first;
  return {every_child, first + 64, 0};
}

std::vector<FirstHitNode> FirstHitTreeBuilder::finish() {
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    std::vector<Entry>& level = levels_[l];
    std::sort(level.begin(), level.end(), [](const Entry& a, const Entry& b) { return a.key < b.key; });
    if (l + 1 == levels_.size()) break;
    std::vector<Entry>& parents = levels_[l + 1];
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (i == 0 || level[i].key >> 6 != level[i - 1].key >> 6) parents.push_back({level[i].key >> 6, {}});
      nodes_.push_back(level[i].node);
      parents.back().node.mask |= std::uint64_t(1) << (level[i].key & 63);
      parents.back().node.end = std::uint32_t(nodes_.size());
    }
    level = {};
    if (nodes_.size() > 0xffffffffu) throw std::length_error("a tree of 2^32 nodes or more; use a coarser lod");
  }
  nodes_[0] = levels_.back().at(0).node;
  return std::move(nodes_);
}

std::vector<FirstHitNode> make_shell(const std::vector<FirstHitNode>& nodes, int bits, int level) {
  std::vector<PlacedMask> masks;
  collect_level(nodes, 0, bits / 2 - 1, level, {0, 0, 0}, masks);
  for (std::size_t axis = 0; axis < 3; ++axis) masks = with_neighbours(masks, axis);
  FirstHitTreeBuilder shell(bits - 2 * level);
  for (const PlacedMask& m : masks) shell.add(m.at, {m.mask, 0, 0});
  return shell.finish();
}

}  // namespace gigabake
