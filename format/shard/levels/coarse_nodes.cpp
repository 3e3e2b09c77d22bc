#include "format/shard/levels/coarse_nodes.h"

#include <algorithm>
#include <bit>

#include "format/shard/check/broken_rule.h"
#include "format/shard/check/node_walk.h"
#include "format/shard/check/shard_check.h"
#include "format/shard/shard_layout.h"

namespace gigabake {
namespace {

/// The classes, child masks and leaf masks of a shard's nodes, read on demand in order from the root.
class Branches {
 public:
  Branches(const ColumnSource& source, const ShardHeader& header, const NodeColumns& columns)
      : kinds_(source.open(columns.kind)), masks_(source.open(columns.child_mask)) {
    if (header.leaf_lod != 0) leaves_ = source.open(columns.leaf_mask);
    BrokenRule{source.path(), "/nodes"}.expect(
        masks_->rows() == rows() && (leaves_ == nullptr || leaves_->rows() == rows()), 0, "columns differ in length");
  }
  std::uint64_t rows() const { return kinds_->rows(); }

  /// Reads at least the rows before `end`. Reads more rows ahead, because unpacking always starts at the beginning of a
  /// chunk.
  void read_to(std::uint64_t end) {
    const std::uint64_t have = kind.size();
    if (end <= have) return;
    const std::uint64_t to = std::min(rows(), std::max({end, 4 * have, first_rows}));
    kind.resize(to), child_mask.resize(to), leaf_mask.resize(to);
    kinds_->read(have, to - have, kind.data() + have);
    masks_->read(have, to - have, child_mask.data() + have);
    if (leaves_ != nullptr) leaves_->read(have, to - have, leaf_mask.data() + have);
  }

  std::vector<NodeKind> kind;
  std::vector<std::uint8_t> child_mask;
  std::vector<std::uint8_t> leaf_mask;  ///< zeros if the shard has no leaves

 private:
  static constexpr std::uint64_t first_rows = 4096;
  std::unique_ptr<StoredRows> kinds_, masks_, leaves_;
};

/// Appends the node at the place of `walk`. Its key is in the table already, because add_row() of its parent appended
/// the keys of all children.
void add_row(const NodeWalk& walk, NodeKind kind, std::uint8_t child_mask, NodeTable& n) {
  const NodePlace& place = walk.place();
  n.lod.push_back(std::uint8_t(place.lod));
  n.kind.push_back(kind);
  n.child_mask.push_back(child_mask);
  n.first_child.push_back(child_mask == 0 ? 0xffffffffu : std::uint32_t(place.next_child));
  n.value.push_back(kind == NodeKind::brick ? std::uint32_t(place.next_brick) : 0);
  const std::uint64_t key = n.key[place.row];
  for (std::uint32_t rest = child_mask; rest != 0; rest &= rest - 1)
    n.key.push_back(key << 3 | std::uint64_t(std::countr_zero(rest)));
}

/// Reads the values of constant nodes. Brick nodes get zeros in `normal` and `directional_coverage`, and keep the brick
/// number in `value`.
void read_constants(const ColumnSource& source, const ShardHeader& header, const NodeColumns& columns, NodeTable& n) {
  n.normal.assign(n.kind.size(), {0, 0});
  n.directional_coverage.assign(header.has_directional_coverage ? n.kind.size() : 0, DirectionalCoverage{});
  n.voxel_class.assign(header.has_classes ? n.kind.size() : 0, no_class);
  const auto is_constant = [](NodeKind kind) { return kind != NodeKind::brick; };
  const auto first = std::find_if(n.kind.begin(), n.kind.end(), is_constant);
  if (first == n.kind.end()) return;
  const BrokenRule table{source.path(), "/nodes"};
  const auto begin = std::uint64_t(first - n.kind.begin());
  table.expect(header.first_lod == 0, begin, "is a constant node of an overview");
  const auto end = std::uint64_t(std::find_if(n.kind.rbegin(), n.kind.rend(), is_constant).base() - n.kind.begin());
  const auto read = [&](const Hdf5Column& column, void* to) {
    const std::unique_ptr<StoredRows> rows = source.open(column);
    table.expect(rows->rows() >= end, 0, "columns differ in length");
    rows->read(begin, end - begin, to);
  };
  std::vector<std::uint32_t> value(end - begin);
  read(columns.value, value.data());
  read(columns.normal, &n.normal[begin]);
  if (header.has_classes) read(columns.voxel_class, &n.voxel_class[begin]);
  std::vector<std::uint8_t> directional_coverage(
      header.has_directional_coverage ? (end - begin) * columns.directional_coverage.row_bytes() : 0);
  if (header.has_directional_coverage) read(columns.directional_coverage, directional_coverage.data());
  std::ranges::copy(directional_coverage_of_rows(directional_coverage, columns.directional_coverage),
                    n.directional_coverage.begin() + std::ptrdiff_t(header.has_directional_coverage ? begin : 0));
  for (std::uint64_t i = begin; i < end; ++i)
    if (is_constant(n.kind[i])) n.value[i] = value[i - begin];
  check_planes_of_nodes(source.path(), 0, n.directional_coverage);
}

}  // namespace

NodeTable read_coarse_nodes(const ColumnSource& source, const ShardHeader& header, std::int32_t version, int begin) {
  const NodeColumns columns(version);
  Branches branches(source, header, columns);
  NodeWalk walk(source.path(), header, branches.rows());
  NodeTable n;
  n.key = {0};
  n.has_finest_planes = has_finest_planes(version, header);
  while (walk.place().row < branches.rows() && int(walk.place().lod) >= begin) {
    const std::uint64_t end = walk.place().level_end;
    branches.read_to(end);
    for (std::uint64_t row = walk.place().row; row < end; ++row) {
      add_row(walk, branches.kind[row], branches.child_mask[row], n);
      if (header.leaf_lod != 0) n.leaf_mask.push_back(branches.leaf_mask[row]);
      walk.step(walk.place().lod, branches.kind[row], branches.child_mask[row], branches.leaf_mask[row]);
    }
    if (walk.place().level_end == end) break;  // no node of this level has a child
  }
  n.key.resize(n.kind.size());
  read_constants(source, header, columns, n);
  return n;
}

}  // namespace gigabake
