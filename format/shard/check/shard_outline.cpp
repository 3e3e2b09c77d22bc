#include "format/shard/check/shard_outline.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace gigabake {

ShardOutline::ShardOutline(const std::filesystem::path& path, const ShardHeader& header,
                           const std::vector<std::uint8_t>& lod, std::vector<NodeKind> kind,
                           std::vector<std::uint8_t> child_mask, const std::vector<std::uint8_t>& leaf_mask)
    : rows_(lod.size()), kind_(std::move(kind)), child_mask_(std::move(child_mask)), bricks_(header.lods, 0) {
  BrokenRule{path, "/nodes"}.expect(
      kind_.size() == rows_ && child_mask_.size() == rows_ && leaf_mask.size() == (header.leaf_lod != 0 ? rows_ : 0), 0,
      "columns differ in length");
  NodeWalk walk(path, header, rows_);
  for (std::uint64_t i = 0; i < rows_; ++i) {
    if (i % rows_per_place == 0) places_.push_back(walk.place());
    walk.step(lod[i], kind_[i], child_mask_[i], leaf_mask.empty() ? std::uint8_t(0) : leaf_mask[i]);
    if (kind_[i] == NodeKind::brick) ++bricks_[lod[i]];
  }
}

std::uint64_t ShardOutline::row_of_brick(int lod, std::uint64_t brick) const {
  const auto is_before = [&](const NodePlace& place) {
    return int(place.lod) > lod || (int(place.lod) == lod && place.next_brick <= brick);
  };
  NodePlace place = *std::prev(std::partition_point(places_.begin(), places_.end(), is_before));
  while (int(place.lod) != lod || place.next_brick != brick || kind_[place.row] != NodeKind::brick) advance(place);
  return place.row;
}

/// Returns the place of the node that has the child `row`.
/// Range   `row` is not the root.
NodePlace ShardOutline::parent_of_row(std::uint64_t row) const {
  const auto is_before = [&](const NodePlace& place) { return place.next_child <= row; };
  NodePlace place = *std::prev(std::partition_point(places_.begin(), places_.end(), is_before));
  while (place.next_child + std::uint64_t(std::popcount(child_mask_[place.row])) <= row) advance(place);
  return place;
}

std::vector<BrickParent> ShardOutline::parents(int lod, std::uint64_t begin, std::uint64_t count) const {
  std::vector<BrickParent> parents;
  if (count == 0) return parents;
  const std::uint64_t first_row = row_of_brick(lod, begin);
  if (first_row == 0) return {BrickParent{}};
  for (NodePlace place = parent_of_row(first_row);; advance(place)) {
    const bool is_brick = kind_[place.row] == NodeKind::brick;
    std::uint64_t child = place.next_child;
    for (std::uint32_t rest = child_mask_[place.row]; rest != 0; rest &= rest - 1, ++child) {
      if (child < first_row || kind_[child] != NodeKind::brick) continue;
      parents.push_back({std::uint32_t(is_brick ? place.next_brick : place.row), 0,
                         is_brick ? BrickParent::brick : BrickParent::constant, std::uint8_t(std::countr_zero(rest))});
      if (parents.size() == count) return parents;
    }
  }
}

}  // namespace gigabake
