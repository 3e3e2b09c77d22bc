#include "format/export/nanovdb/nanovdb_tree.h"

#include <algorithm>

namespace gigabake {
namespace {

using nanovdb_layout::IndexBox;

void widen_to(IndexBox& box, const IndexBox& other) {
  box.min = min_by_axis(box.min, other.min);
  box.max = max_by_axis(box.max, other.max);
}

/// Returns the inner node whose range of children contains `child`.
NanovdbInnerNode& parent_of(std::vector<NanovdbInnerNode>& nodes, std::uint32_t child) {
  const auto after = std::upper_bound(nodes.begin(), nodes.end(), child,
                                      [](std::uint32_t c, const NanovdbInnerNode& n) { return c < n.first_child; });
  return *(after - 1);
}

}  // namespace

NanovdbLeafKey nanovdb_leaf_key(const LevelIndex& lowest) {
  NanovdbLeafKey key;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto index = std::uint32_t(lowest[c]);
    key.root |= std::uint64_t(index >> 12) << (21 * (2 - c));
    key.upper |= (index >> 7 & 31) << (5 * (2 - c));
    key.lower = std::uint16_t(key.lower | (index >> 3 & 15) << (4 * (2 - c)));
  }
  return key;
}

void NanovdbTree::finish() {
  std::sort(leaves_.begin(), leaves_.end());
  leaves_.erase(std::unique(leaves_.begin(), leaves_.end()), leaves_.end());
  for (std::uint32_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    const NanovdbLeafKey& key = leaves_[leaf];
    const bool other_root = leaf == 0 || key.root != leaves_[leaf - 1].root;
    if (other_root || key.upper != leaves_[leaf - 1].upper) {
      if (other_root) upper_.push_back({std::uint32_t(lower_.size()), 0, {}});
      lower_.push_back({leaf, 0, {}});
      ++upper_.back().children;
    }
    ++lower_.back().children;
  }
}

std::uint32_t NanovdbTree::leaf(const LevelIndex& lowest) const {
  const NanovdbLeafKey key = nanovdb_leaf_key(lowest);
  const auto found = std::lower_bound(leaves_.begin(), leaves_.end(), key);
  return std::uint32_t((found != leaves_.end() && *found == key ? found : leaves_.end()) - leaves_.begin());
}

void NanovdbTree::widen(std::uint32_t leaf, const IndexBox& box) {
  NanovdbInnerNode& lower = parent_of(lower_, leaf);
  widen_to(lower.box, box);
  widen_to(parent_of(upper_, std::uint32_t(&lower - lower_.data())).box, box);
  widen_to(box_, box);
}

}  // namespace gigabake
