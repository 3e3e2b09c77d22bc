/// Writer of one grid of a NanoVDB file. Leaves can be written in any order.
#pragma once

#include <string>
#include <vector>

#include "core/math/vec3.h"
#include "format/export/nanovdb/nanovdb_layout.h"
#include "format/export/nanovdb/nanovdb_tree.h"
#include "format/system/random_access_file.h"

namespace gigabake {

/// Properties shared by all grids of a file.
struct NanovdbFrame {
  double voxel_size_m = 0;  ///< edge of a voxel of the exported level
  Vec3d lattice_origin_m{};
  std::uint64_t voxels = 0;
};

/// One grid. `Value` is Rgba8, Vec3f or UInt32 of nanovdb_layout. Borrows the tree.
template <class Value>
class NanovdbGrid {
 public:
  NanovdbGrid(std::string name, const NanovdbTree& tree, const NanovdbFrame& frame);

  std::uint64_t bytes() const { return leaf_offset(std::uint32_t(tree_.leaves().size())); }
  const std::string& name() const { return name_; }
  /// Returns the metadata. Call it after the last NanovdbTree::widen().
  nanovdb_layout::FileMetaData meta_data() const;

  /// Sets the grid's offset in the file.
  void begin_at(std::uint64_t offset) { begin_ = offset; }
  /// Adds voxels to leaf `leaf` in the file. `merge` must be true if the leaf has voxels already.
  void write_leaf(RandomAccessFile& file, std::uint32_t leaf, const nanovdb_layout::LeafNode<Value>& voxels,
                  bool merge) const;
  /// Writes everything except the leaves. Call it after the last NanovdbTree::widen().
  void write_nodes(RandomAccessFile& file) const;

 private:
  using Root = nanovdb_layout::RootData<Value>;
  using Upper = nanovdb_layout::UpperNode<Value>;
  using Lower = nanovdb_layout::LowerNode<Value>;
  using Leaf = nanovdb_layout::LeafNode<Value>;

  // Offsets from the start of the grid.
  static constexpr std::uint64_t root_offset = sizeof(nanovdb_layout::GridData) + sizeof(nanovdb_layout::TreeData);
  std::uint64_t upper_offset(std::uint64_t n) const {
    return root_offset + sizeof(Root) + tree_.upper().size() * sizeof(nanovdb_layout::RootTile) + n * sizeof(Upper);
  }
  std::uint64_t lower_offset(std::uint64_t n) const { return upper_offset(tree_.upper().size()) + n * sizeof(Lower); }
  std::uint64_t leaf_offset(std::uint64_t n) const { return lower_offset(tree_.lower().size()) + n * sizeof(Leaf); }

  std::vector<std::uint8_t> head() const;
  nanovdb_layout::GridData grid_data() const;
  nanovdb_layout::TreeData tree_data() const;

  std::string name_;
  const NanovdbTree& tree_;
  NanovdbFrame frame_;
  std::uint64_t begin_ = 0;
};

}  // namespace gigabake
