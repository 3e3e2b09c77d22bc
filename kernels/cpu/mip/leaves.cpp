#include "kernels/cpu/mip/leaves.h"

#include <bit>
#include <utility>

#include "kernels/body/mip/leaf.h"
#include "kernels/body/mip/mip.h"
#include "kernels/cpu/mip/level_read.h"

namespace gigabake::kernels {
namespace {

/// Appends voxels of both levels to a joint level, in the order of its bricks.
class LeafJoiner {
 public:
  LeafJoiner(const Level& level, const LevelSurface& surface, const Level& leaves, int lod, MipFilter filter)
      : level_(level),
        surface_(surface),
        leaves_(leaves),
        edge_(raster_edge(lod)),
        words_(std::size_t(raster_words(edge_))),
        has_views_(filters_by_view(filter)),
        has_normals_(!leaves.normal.empty()),
        tables_(TableStore::host().view()) {
    joint.first.push_back(0);
  }

  /// Appends the next brick, which exists in at least one of the levels.
  void add_brick() {
    const bool in_level =
        brick_ < level_.key.size() && (leaf_ == leaves_.key.size() || level_.key[brick_] <= leaves_.key[leaf_]);
    const bool in_leaves = leaf_ < leaves_.key.size() && (!in_level || leaves_.key[leaf_] == level_.key[brick_]);
    joint.key.push_back(in_level ? level_.key[brick_] : leaves_.key[leaf_]);
    for (std::size_t word = 0; word < brick_edge; ++word) {
      const std::uint64_t filtered = in_level ? level_.mask[brick_edge * brick_ + word] : 0,
                          leaf = in_leaves ? leaves_.mask[brick_edge * leaf_ + word] : 0;
      joint.mask.push_back(filtered | leaf);
      for (std::uint64_t rest = filtered | leaf; rest != 0; rest &= rest - 1)
        if ((filtered >> std::countr_zero(rest) & 1) != 0)
          copy_voxel(voxel_++);
        else
          add_leaf(leaf_voxel_++);
    }
    joint.first.push_back(joint.rgba.size() / 4);
    brick_ += in_level ? 1 : 0;
    leaf_ += in_leaves ? 1 : 0;
  }

  bool is_done() const { return brick_ == level_.key.size() && leaf_ == leaves_.key.size(); }

  Level joint;
  LevelSurface joint_surface;

 private:
  template <class Item>
  static void copy(const std::vector<Item>& from, std::size_t i, std::size_t count, std::vector<Item>& to) {
    if (!from.empty())
      to.insert(to.end(), from.begin() + std::ptrdiff_t(i * count), from.begin() + std::ptrdiff_t((i + 1) * count));
  }

  void copy_voxel(std::size_t i) {
    copy(level_.rgba, i, 4, joint.rgba);
    copy(level_.voxel_class, i, 1, joint.voxel_class);
    copy(level_.normal, i, 2, joint.normal);
    copy(level_.directional_coverage, i, directional_coverage_bytes, joint.directional_coverage);
    copy(surface_.rasters, i, words_, joint_surface.rasters);
    copy(surface_.patches, i, 1, joint_surface.patches);
  }

  void add_leaf(std::size_t i) {
    copy(leaves_.rgba, i, 4, joint.rgba);
    copy(leaves_.voxel_class, i, 1, joint.voxel_class);
    copy(leaves_.normal, i, 2, joint.normal);
    if (!has_views_) return;
    const Voxel leaf = voxel_at(leaves_, i);
    const std::uint8_t plane =
        leaves_.directional_coverage.empty()
            ? std::uint8_t(0)
            : leaves_.directional_coverage[directional_coverage_bytes * i + directional_coverage_plane];
    std::uint32_t raster[raster_words(max_raster_edge)];
    set_leaf_raster(leaf, plane, has_normals_, edge_, tables_, raster);
    joint_surface.rasters.insert(joint_surface.rasters.end(), raster, raster + words_);
    std::uint8_t coverage[directional_coverage_bytes];
    set_leaf_coverage(leaf, plane, coverage);
    joint.directional_coverage.insert(joint.directional_coverage.end(), coverage,
                                      coverage + directional_coverage_bytes);
    if (has_normals_) joint_surface.patches.push_back(leaf_patch(leaf, plane, tables_));
  }

  const Level& level_;
  const LevelSurface& surface_;
  const Level& leaves_;
  int edge_;
  std::size_t words_;
  bool has_views_, has_normals_;
  Tables tables_;
  std::size_t brick_ = 0, leaf_ = 0, voxel_ = 0, leaf_voxel_ = 0;
};

}  // namespace

void add_leaves(Level& level, LevelSurface& surface, const Level& leaves, int lod, MipFilter filter) {
  if (leaves.key.empty()) return;
  LeafJoiner joiner(level, surface, leaves, lod, filter);
  while (!joiner.is_done()) joiner.add_brick();
  level = std::move(joiner.joint);
  surface = std::move(joiner.joint_surface);
}

}  // namespace gigabake::kernels
