#include "format/export/nanovdb/nanovdb.h"

#include <cmath>
#include <cstring>
#include <optional>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "format/export/nanovdb/nanovdb_grid.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

using namespace nanovdb_layout;

/// Converts a brick to a leaf. value(v) returns the stored value of voxel v of the brick.
template <class Value, class ValueOf>
LeafNode<Value> leaf_of(const LevelIndex& lowest, const DenseBrick& brick, const ValueOf& value) {
  auto leaf = LeafNode<Value>();
  IndexBox box;
  for (std::size_t voxel = 0; voxel < brick_voxels; ++voxel) {
    if (!brick.has(voxel)) continue;
    const Vec3<std::size_t> at{voxel & 7, voxel >> 3 & 7, voxel >> 6};
    const std::size_t n = at[0] << 6 | at[1] << 3 | at[2];
    leaf.mask[n >> 6] |= std::uint64_t(1) << (n & 63);
    leaf.values[n] = value(voxel);
    const Vec3<std::int32_t> index(lowest + Vec3i64(at));
    box.min = min_by_axis(box.min, index);
    box.max = max_by_axis(box.max, index);
  }
  leaf.box_min = box.min;
  leaf.box_extent = Vec3<std::uint8_t>(box.max - box.min);
  return leaf;
}

IndexBox box_of(const LeafNode<Rgba8>& leaf) {
  IndexBox box{leaf.box_min, leaf.box_min};
  box.max += Vec3<std::int32_t>(leaf.box_extent);
  return box;
}

NanovdbTree tree_of(const PagedScene& scene, int lod, const Progress& progress) {
  NanovdbTree tree;
  const auto add = [&](const LevelIndex& lowest, const DenseBrick&) {
    for (const std::int64_t i : lowest)
      if (i != std::int32_t(i))
        throw InputError(scene.file(), "LatticeMin", "NanoVDB cannot store indices of more than 32 bits");
    tree.add(lowest);
  };
  for_each_block_part(scene, lod, add, progress);
  tree.finish();
  return tree;
}

/// Writer of the grids of a file. The constructor determines their offsets.
class NanovdbWriter {
 public:
  NanovdbWriter(NanovdbTree& tree, const NanovdbFrame& frame, bool normals, bool classes)
      : tree_(tree), rgba_("rgba", tree, frame), written_(tree.leaves().size()) {
    if (normals) normal_.emplace("normal", tree, frame);
    if (classes) class_.emplace("class", tree, frame);
    std::uint64_t at = sizeof(FileHeader);
    for_each_grid(*this, [&](auto& grid) { at += head_bytes(grid); });
    for_each_grid(*this, [&](auto& grid) {
      grid.begin_at(at);
      at += grid.bytes();
    });
    bytes_ = at;
  }

  std::uint64_t bytes() const { return bytes_; }

  /// Writes the voxels of a brick to the leaf at `lowest`. Returns false if the tree has no leaf there.
  bool write_leaf(RandomAccessFile& file, const LevelIndex& lowest, const DenseBrick& brick) {
    const std::uint32_t leaf = tree_.leaf(lowest);
    if (leaf == written_.size()) return false;
    const auto rgba = leaf_of<Rgba8>(lowest, brick, [&](std::size_t voxel) { return Rgba8{brick.rgba[voxel]}; });
    rgba_.write_leaf(file, leaf, rgba, written_[leaf]);
    if (normal_)
      normal_->write_leaf(
          file, leaf,
          leaf_of<Vec3f>(lowest, brick,
                         [&](std::size_t voxel) { return Vec3f{unit_normal(brick.normal[voxel].data())}; }),
          written_[leaf]);
    if (class_)
      class_->write_leaf(
          file, leaf,
          leaf_of<UInt32>(lowest, brick, [&](std::size_t voxel) { return UInt32{brick.voxel_class[voxel]}; }),
          written_[leaf]);
    written_[leaf] = true;
    tree_.widen(leaf, box_of(rgba));
    return true;
  }

  /// Writes everything except the leaves. Call it after the last write_leaf().
  void write_nodes(RandomAccessFile& file) {
    FileHeader header;
    for_each_grid(*this, [&](const auto&) { ++header.grids; });
    file.write_value(0, header);
    std::uint64_t at = sizeof header;
    for_each_grid(*this, [&](const auto& grid) { at = write_meta_data(file, at, grid); });
    for_each_grid(*this, [&](const auto& grid) { grid.write_nodes(file); });
  }

 private:
  /// Visits the grids in the order of the file. `self` is the writer, constant or not.
  template <class Self, class Visit>
  static void for_each_grid(Self& self, const Visit& visit) {
    visit(self.rgba_);
    if (self.normal_) visit(*self.normal_);
    if (self.class_) visit(*self.class_);
  }
  template <class Value>
  static std::uint64_t head_bytes(const NanovdbGrid<Value>& grid) {
    return sizeof(FileMetaData) + grid.name().size() + 1;
  }
  /// Writes the metadata of a grid at offset `at`. Returns the offset of the next grid's metadata.
  template <class Value>
  static std::uint64_t write_meta_data(RandomAccessFile& file, std::uint64_t at, const NanovdbGrid<Value>& grid) {
    file.write_value(at, grid.meta_data());
    file.write(at + sizeof(FileMetaData),
               {reinterpret_cast<const std::uint8_t*>(grid.name().c_str()), grid.name().size() + 1});
    return at + head_bytes(grid);
  }

  NanovdbTree& tree_;
  NanovdbGrid<Rgba8> rgba_;
  std::optional<NanovdbGrid<Vec3f>> normal_;
  std::optional<NanovdbGrid<UInt32>> class_;
  std::vector<bool> written_;
  std::uint64_t bytes_ = 0;
};

}  // namespace

std::uint64_t export_nanovdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& nvdb,
                             const Progress& progress) {
  const auto [scene, voxels] = open_scene_level(scene_xml, lod);
  Publication publication(nvdb, Leftovers::remove);
  progress.step("finding the bricks", voxels);
  NanovdbTree tree = tree_of(scene, lod, progress);
  const SceneHeader& header = scene.header();
  NanovdbWriter writer(tree, {std::ldexp(header.voxel_size_m, lod), header.lattice_origin_m, voxels},
                       header.has_normals, header.has_classes);
  {
    RandomAccessFile file(nvdb, publication.temporary(), writer.bytes());
    progress.step("writing the voxels", voxels);
    const auto write = [&](const LevelIndex& lowest, const DenseBrick& brick) {
      if (!writer.write_leaf(file, lowest, brick))
        throw InputError(scene_xml, "", "its shards changed during the export");
    };
    for_each_block_part(scene, lod, write, progress);
    writer.write_nodes(file);
  }
  publication.publish();
  return voxels;
}

}  // namespace gigabake
