#include "query/query_tree.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "core/base/error.h"
#include "format/scene/expanded_leaves.h"
#include "format/scene/shard_of_scene.h"
#include "format/shard/levels/coarse_levels.h"

namespace gigabake {
namespace {

/// The width by which voxels grow at the window's faces, as a fraction of the tree's edge. It is twice the error of the
/// traversal relative to the exact ray. Voxels of both windows grow at a common face.
constexpr double rim = 0x1p-19;

/// Bytes that a tree requires while it is built, measured on surfaces. A voxel requires its columns, twice its
/// attributes (vector growth), and its fraction of the nodes. A brick requires a mask and three copies of up to eight
/// nodes. A constant node requires 64 attributes and a node. An octant of leaves has some 24 voxels, each a constant
/// node, or cut by its plane to some 20 voxels.
constexpr std::uint64_t leaves_per_octant = 24, voxels_per_constant = 64, bytes_per_cut_leaf = 500;
/// Bytes of a class: in the column and, with vector growth, twice in the tree.
constexpr std::uint64_t bytes_per_class = 6;
constexpr std::uint64_t bytes_per_voxel = 26, bytes_per_brick = 600, bytes_per_constant = 1200, bytes_of_all = 1u << 16;

}  // namespace

QueryTreeSource::QueryTreeSource(const PagedScene& scene, const SceneCell& shard, int lod)
    : path_(scene.folder() / shard.file),
      shard_(shard),
      shard_lod_(lod - int(shard.first_lod)),
      reader_(open_shard_of_scene(scene.file(), scene.header(), shard)),
      nodes_(reader_.nodes()),
      leaf_shape_(leaf_shape_of(scene.header())) {
  std::uint64_t in_constants = 0;
  for (std::size_t n = 0; n < nodes_.lod.size(); ++n) {
    const int above = int(nodes_.lod[n]) - shard_lod_;
    if (above > 0 && !nodes_.leaf_mask.empty()) leaf_octants_ += std::uint64_t(std::popcount(nodes_.leaf_mask[n]));
    if (above == 0 && nodes_.kind[n] == NodeKind::brick) {
      ++bricks_;
    } else if (above == 0 || (above > 0 && nodes_.kind[n] == NodeKind::leaf_constant)) {
      ++constants_;
      in_constants += std::uint64_t(brick_voxels) << (3 * above);
    }
  }
  const std::uint64_t voxels =
      std::size_t(shard_lod_) < shard.voxels.size() ? shard.voxels[std::size_t(shard_lod_)] : 0;
  stored_voxels_ = std::min(voxels - std::min(voxels, in_constants), bricks_ * brick_voxels);
}

std::uint64_t QueryTreeSource::bytes_to_build() const {
  const std::uint64_t of_classes =
      reader_.header().has_classes
          ? bytes_per_class * (stored_voxels_ + voxels_per_constant * (constants_ + leaf_octants_ * leaves_per_octant))
          : 0;
  return stored_voxels_ * bytes_per_voxel + bricks_ * bytes_per_brick + constants_ * bytes_per_constant +
         leaf_octants_ * leaves_per_octant *
             (leaf_shape_ == LeafShape::plane ? bytes_per_cut_leaf : bytes_per_constant) +
         of_classes + bytes_of_all;
}

QueryTree::QueryTree(const QueryTreeSource& source) {
  const double unit = kernels::power_of_two(int(source.shard_.first_lod));
  view_.unit = unit;
  view_.half_window = 0.5 * source.shard_.cell_voxels / unit;
  view_.shard_lod = source.shard_lod_;
  view_.lod = int(source.shard_.first_lod) + source.shard_lod_;
  for (std::size_t a = 0; a < 3; ++a) {
    view_.window.min[a] = source.shard_.lattice_min[a];
    view_.window.max[a] = source.shard_.lattice_min[a] + source.shard_.cell_voxels;
  }
  try {
    FirstHitBuilder builder(source.shard_lod_);
    if (source.leaf_octants_ == 0) {
      builder.add_cell({0, 0, 0}, source.nodes_, source.reader_.level(source.shard_lod_));
    } else {
      const CoarseLevels coarse = source.reader_.coarse_levels(source.shard_lod_);
      builder.add_cell({0, 0, 0}, source.nodes_, coarse.levels.front());
      builder.add_leaves({0, 0, 0}, source.nodes_, coarse.levels, source.leaf_shape_);
    }
    scene_ = builder.finish_window(std::int64_t(source.shard_.cell_voxels) >> view_.lod);
  } catch (const std::invalid_argument& error) {
    throw InputError(source.path_, "", error.what());
  } catch (const std::length_error& error) {
    throw InputError(source.path_, "", error.what());
  }
  view_.tree = scene_.view.tree;
  view_.attributes = scene_.view.attributes;
  view_.classes = {scene_.classes.data(), scene_.classes.size()};
  std::ranges::copy(scene_.lattice_min, view_.tree_min);
  view_.grown = 1 + rim * double(scene_.view.tree.edge) / view_.half_window;
}

}  // namespace gigabake
