#include "format/shard/check/node_walk.h"

#include <bit>

namespace gigabake {
namespace {

constexpr std::uint32_t no_child = 0xffffffffu;

}  // namespace

void NodePlace::advance(NodeKind kind, std::uint8_t child_mask) {
  next_child += std::uint64_t(std::popcount(child_mask));
  if (kind == NodeKind::brick) ++next_brick;
  if (++row < level_end || next_child == row) return;
  level_end = next_child;
  next_brick = 0;
  --lod;
}

NodeWalk::NodeWalk(const std::filesystem::path& path, const ShardHeader& header, std::uint64_t rows)
    : NodeWalk(path, header, {.lod = header.lods - 1}, rows) {}

NodeWalk::NodeWalk(const std::filesystem::path& path, const ShardHeader& header, const NodePlace& place,
                   std::uint64_t rows)
    : table_{path, "/nodes"},
      place_(place),
      rows_(rows),
      end_of_leaves_(header.leaf_lod == 0 ? 0 : header.leaf_lod - header.first_lod + 1) {
  table_.expect(rows > 0 && rows < no_child, 0, "expected 1 to 2^32-2 nodes");
}

void NodeWalk::check_links(NodeKind kind, std::uint8_t child_mask, std::uint32_t first_child,
                           std::uint32_t value) const {
  if (child_mask == 0)
    table_.expect(first_child == no_child, place_.row, "first_child without children");
  else
    table_.expect(first_child == place_.next_child, place_.row, "first_child is out of order");
  table_.expect(kind != NodeKind::brick || value == place_.next_brick, place_.row,
                "value is not the next brick of its level");
}

void NodeWalk::step(std::uint32_t lod, NodeKind kind, std::uint8_t child_mask, std::uint8_t leaf_mask) {
  const std::uint64_t row = place_.row;
  const int children = std::popcount(child_mask);
  table_.expect(row < place_.level_end, row, "has no parent");
  table_.expect(lod == place_.lod, row, "lod does not follow its parent's lod");
  table_.expect(kind <= NodeKind::leaf_constant, row, "the node's type is unknown");
  const bool is_leaf = lod == 0 || kind == NodeKind::leaf_constant;
  table_.expect(leaf_mask == 0 || (!is_leaf && lod < end_of_leaves_), row, "has leaves where the shard allows none");
  table_.expect((leaf_mask & child_mask) == 0, row, "an octant is a leaf and has a child");
  table_.expect(is_leaf || children > 0 || leaf_mask != 0, row, "children are missing");
  table_.expect(!is_leaf || children == 0, row, "a leaf has children");
  table_.expect(place_.next_child + std::uint64_t(children) <= rows_, row, "has more children than there are rows");
  place_.advance(kind, child_mask);
}

}  // namespace gigabake
