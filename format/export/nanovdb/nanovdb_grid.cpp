#include "format/export/nanovdb/nanovdb_grid.h"

#include <cstring>
#include <memory>
#include <utility>
#include <zlib.h>

namespace gigabake {
namespace {

using namespace nanovdb_layout;

/// Returns the hash of a grid's name, as NanoVDB's file format defines it.
std::uint64_t name_key(const std::string& name) {
  std::uint64_t hash = 0;
  for (const char c : name) {
    const std::uint64_t overflow = hash >> 56;
    hash = hash * 67 + std::uint8_t(c) + overflow;
  }
  return hash;
}

std::array<double, 6> world_box(const NanovdbFrame& frame, const IndexBox& box) {
  std::array<double, 6> world{};
  for (std::size_t c = 0; c < 3; ++c) {
    world[c] = frame.lattice_origin_m[c] + frame.voxel_size_m * box.min[c];
    world[c + 3] = frame.lattice_origin_m[c] + frame.voxel_size_m * (double(box.max[c]) + 1);
  }
  return world;
}

Map map_of(const NanovdbFrame& frame) {
  Map map;
  for (std::size_t c = 0; c < 3; ++c) {
    map.matrix[4 * c] = frame.voxel_size_m;
    map.inverse[4 * c] = 1 / frame.voxel_size_m;
    map.translation[c] = frame.lattice_origin_m[c];
    map.matrix_f[4 * c] = float(map.matrix[4 * c]);
    map.inverse_f[4 * c] = float(map.inverse[4 * c]);
    map.translation_f[c] = float(map.translation[c]);
  }
  return map;
}

template <class T>
void append(std::vector<std::uint8_t>& bytes, const T& value) {
  bytes.resize(bytes.size() + sizeof(T));
  std::memcpy(bytes.data() + bytes.size() - sizeof(T), &value, sizeof(T));
}

template <class Node>
void set_child(Node& node, std::uint32_t child, std::uint64_t offset) {
  node.child_mask[child >> 6] |= std::uint64_t(1) << (child & 63);
  node.table[child].offset = std::int64_t(offset);
}

}  // namespace

template <class Value>
NanovdbGrid<Value>::NanovdbGrid(std::string name, const NanovdbTree& tree, const NanovdbFrame& frame)
    : name_(std::move(name)), tree_(tree), frame_(frame) {}

template <class Value>
FileMetaData NanovdbGrid<Value>::meta_data() const {
  FileMetaData meta;
  meta.grid_bytes = meta.file_bytes = bytes();
  meta.name_key = name_key(name_);
  meta.voxels = frame_.voxels;
  meta.grid_type = Value::grid_type;
  meta.index_box = tree_.box();
  meta.world_box = world_box(frame_, tree_.box());
  meta.voxel_size = Vec3d::all(frame_.voxel_size_m);
  meta.name_bytes = std::uint32_t(name_.size() + 1);
  const TreeData tree = tree_data();
  for (std::size_t level = 0; level < 3; ++level) meta.nodes[level] = tree.nodes[level];
  return meta;
}

template <class Value>
GridData NanovdbGrid<Value>::grid_data() const {
  GridData grid;
  grid.flags |= has_bbox;
  grid.grid_bytes = bytes();
  std::memcpy(grid.name.data(), name_.data(), name_.size());
  grid.map = map_of(frame_);
  grid.world_box = world_box(frame_, tree_.box());
  grid.voxel_size = Vec3d::all(frame_.voxel_size_m);
  grid.grid_type = Value::grid_type;
  return grid;
}

template <class Value>
TreeData NanovdbGrid<Value>::tree_data() const {
  TreeData tree;
  tree.node_offset = {leaf_offset(0), lower_offset(0), upper_offset(0), root_offset};
  for (std::uint64_t& offset : tree.node_offset) offset -= sizeof(GridData);
  tree.nodes = {std::uint32_t(tree_.leaves().size()), std::uint32_t(tree_.lower().size()),
                std::uint32_t(tree_.upper().size())};
  tree.voxels = frame_.voxels;
  return tree;
}

template <class Value>
std::vector<std::uint8_t> NanovdbGrid<Value>::head() const {
  std::vector<std::uint8_t> bytes;
  append(bytes, grid_data());
  append(bytes, tree_data());
  auto root = Root();
  root.box = tree_.box();
  root.tiles = std::uint32_t(tree_.upper().size());
  append(bytes, root);
  for (std::size_t n = 0; n < tree_.upper().size(); ++n) {
    RootTile tile;
    tile.key = tree_.leaves()[tree_.lower()[tree_.upper()[n].first_child].first_child].root;
    tile.child = std::int64_t(upper_offset(n) - root_offset);
    append(bytes, tile);
  }
  constexpr std::size_t unhashed = 16;  // the magic number and the checksums themselves
  const auto crc = std::uint32_t(crc32(0, bytes.data() + unhashed, uInt(bytes.size() - unhashed)));
  std::memcpy(bytes.data() + offsetof(GridData, head_crc), &crc, sizeof crc);
  return bytes;
}

template <class Value>
void NanovdbGrid<Value>::write_leaf(RandomAccessFile& file, std::uint32_t leaf, const Leaf& voxels, bool merge) const {
  const std::uint64_t at = begin_ + leaf_offset(leaf);
  if (!merge) return file.write_value(at, voxels);
  auto merged = Leaf();
  file.read_value(at, merged);
  const auto max_of = [](const Leaf& l) { return l.box_min + Vec3<std::int32_t>(l.box_extent); };
  const Vec3<std::int32_t> max = max_by_axis(max_of(merged), max_of(voxels));
  merged.box_min = min_by_axis(merged.box_min, voxels.box_min);
  merged.box_extent = Vec3<std::uint8_t>(max - merged.box_min);
  for (std::size_t n = 0; n < merged.values.size(); ++n)
    if (voxels.mask[n >> 6] >> (n & 63) & 1) merged.values[n] = voxels.values[n];
  for (std::size_t word = 0; word < merged.mask.size(); ++word) merged.mask[word] |= voxels.mask[word];
  file.write_value(at, merged);
}

template <class Value>
void NanovdbGrid<Value>::write_nodes(RandomAccessFile& file) const {
  file.write(begin_, head());
  for (std::size_t n = 0; n < tree_.upper().size(); ++n) {
    const NanovdbInnerNode& node = tree_.upper()[n];
    const auto upper = std::make_unique<Upper>();
    upper->box = node.box;
    for (std::uint32_t child = node.first_child; child < node.first_child + node.children; ++child)
      set_child(*upper, tree_.leaves()[tree_.lower()[child].first_child].upper, lower_offset(child) - upper_offset(n));
    file.write_value(begin_ + upper_offset(n), *upper);
  }
  for (std::size_t n = 0; n < tree_.lower().size(); ++n) {
    const NanovdbInnerNode& node = tree_.lower()[n];
    const auto lower = std::make_unique<Lower>();
    lower->box = node.box;
    for (std::uint32_t child = node.first_child; child < node.first_child + node.children; ++child)
      set_child(*lower, tree_.leaves()[child].lower, leaf_offset(child) - lower_offset(n));
    file.write_value(begin_ + lower_offset(n), *lower);
  }
}

template class NanovdbGrid<Rgba8>;
template class NanovdbGrid<Vec3f>;
template class NanovdbGrid<UInt32>;

}  // namespace gigabake
