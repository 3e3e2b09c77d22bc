#include "format/scene/expanded_leaves.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "core/octree/parameters.h"

namespace gigabake {
namespace {

/// Edge of an octant in voxels, and the levels from a leaf-constant node to a voxel of the node's size.
constexpr int octant_edge = brick_edge / 2, node_levels = 3;

class LeafExpander {
 public:
  LeafExpander(int lod, LeafShape shape, bool has_normals, bool has_classes, BrickLevel& level)
      : lod_(lod), shape_(shape), has_normals_(has_normals), has_classes_(has_classes), level_(level) {
    if (level_.first.empty()) level_.first.push_back(0);
    level_.directional_coverage = {};
  }

  /// Keeps the nodes that represent voxels of the level.
  void keep_nodes(const NodeTable& from) {
    for (std::size_t n = 0; n < from.key.size(); ++n)
      if (from.lod[n] == lod_ || (from.lod[n] > lod_ && from.kind[n] == NodeKind::leaf_constant))
        add_node(from.key[n], from.lod[n], from.kind[n], from.value[n], from.normal[n], class_of_constant(from, n));
  }

  void add_octant(const LeafVoxels& leaves) {
    const int coarser = leaves.lod - lod_;
    if (coarser < node_levels || (coarser == node_levels && shape_ == LeafShape::plane))
      return add_bricks(leaves, coarser);
    for_each_leaf(leaves, [&](const Vec3<int>& at, const std::uint8_t* rgba, const std::int8_t* normal,
                              const std::uint8_t*, VoxelClass voxel_class) {
      const Vec3i64 voxel = leaves.octant * octant_edge + static_cast<Vec3i64>(at);
      add_node(morton(std::uint32_t(voxel[0]), std::uint32_t(voxel[1]), std::uint32_t(voxel[2])),
               std::uint8_t(leaves.lod - node_levels), NodeKind::leaf_constant,
               std::uint32_t(rgba[0] | rgba[1] << 8 | rgba[2] << 16) | std::uint32_t(rgba[3]) << 24,
               {normal[0], normal[1]}, voxel_class);
    });
  }

  /// Returns the nodes, sorted by level, from the root down, and then by key.
  NodeTable take_nodes() {
    std::vector<std::size_t> order(nodes_.key.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::sort(order, {}, [this](std::size_t n) { return std::make_tuple(-int(nodes_.lod[n]), nodes_.key[n]); });
    NodeTable sorted;
    for (const std::size_t n : order) {
      sorted.key.push_back(nodes_.key[n]);
      sorted.lod.push_back(nodes_.lod[n]);
      sorted.kind.push_back(nodes_.kind[n]);
      sorted.value.push_back(nodes_.value[n]);
      sorted.normal.push_back(nodes_.normal[n]);
      if (has_classes_) sorted.voxel_class.push_back(nodes_.voxel_class[n]);
    }
    sorted.child_mask.assign(order.size(), 0);
    sorted.first_child.assign(order.size(), 0xffffffffu);
    return sorted;
  }

 private:
  struct OpenBrick {
    std::array<std::uint64_t, brick_edge> mask{};
    std::array<std::array<std::uint8_t, 4>, brick_voxels> rgba{};
    std::array<std::array<std::int8_t, 2>, brick_voxels> normal{};
    std::array<VoxelClass, brick_voxels> voxel_class{};

    void set(const Vec3<int>& voxel, const std::uint8_t* colour, const std::int8_t* octahedral, VoxelClass of_voxel) {
      const auto z = std::size_t(voxel[2] & 7);
      const int bit = (voxel[0] & 7) + 8 * (voxel[1] & 7);
      mask[z] |= std::uint64_t(1) << bit;
      std::copy_n(colour, 4, rgba[64 * z + std::size_t(bit)].begin());
      std::copy_n(octahedral, 2, normal[64 * z + std::size_t(bit)].begin());
      voxel_class[64 * z + std::size_t(bit)] = of_voxel;
    }
  };

  void add_node(std::uint64_t key, std::uint8_t lod, NodeKind kind, std::uint32_t value,
                const std::array<std::int8_t, 2>& normal, VoxelClass voxel_class) {
    nodes_.voxel_class.push_back(voxel_class);
    nodes_.key.push_back(key);
    nodes_.lod.push_back(lod);
    nodes_.kind.push_back(kind);
    nodes_.value.push_back(value);
    nodes_.normal.push_back(normal);
  }

  /// Adds an octant as one brick, or as eight or more if its voxels are four or more times as wide as the level's.
  void add_bricks(const LeafVoxels& leaves, int coarser) {
    const int along = 1 << (coarser - 1), edge = 1 << coarser;  // bricks of the octant, voxels of a leaf along an edge
    std::vector<OpenBrick> bricks(std::size_t(along * along * along));
    for_each_leaf(leaves, [&](const Vec3<int>& at, const std::uint8_t* rgba, const std::int8_t* normal,
                              const std::uint8_t* coverage, VoxelClass voxel_class) {
      const auto set = [&](const Vec3<int>& in_leaf) {
        const Vec3<int> voxel = at * edge + in_leaf;
        bricks[morton(std::uint32_t(voxel[0] >> 3), std::uint32_t(voxel[1] >> 3), std::uint32_t(voxel[2] >> 3))].set(
            voxel, rgba, normal, voxel_class);
      };
      const std::uint8_t plane = coverage == nullptr ? std::uint8_t(0) : coverage[directional_coverage_plane];
      if (is_cut(shape_, coarser, plane))
        return for_each_crossed(normal, plane, coarser, [&](const Vec3<int>& part, std::uint8_t) { set(part); });
      for (int i = 0; i < edge * edge * edge; ++i) set({i % edge, i / edge % edge, i / edge / edge});
    });
    const std::uint64_t key =
        morton(std::uint32_t(leaves.octant[0]), std::uint32_t(leaves.octant[1]), std::uint32_t(leaves.octant[2]))
        << 3 * (coarser - 1);
    for (std::size_t b = 0; b < bricks.size(); ++b) append(key + b, bricks[b]);
  }

  void append(std::uint64_t key, const OpenBrick& brick) {
    const std::uint64_t before = level_.first.back();
    std::uint64_t voxels = before;
    for (std::size_t z = 0; z < brick.mask.size(); ++z)
      for (std::uint64_t rest = brick.mask[z]; rest != 0; rest &= rest - 1, ++voxels) {
        const std::size_t voxel = 64 * z + std::size_t(std::countr_zero(rest));
        level_.rgba.insert(level_.rgba.end(), brick.rgba[voxel].begin(), brick.rgba[voxel].end());
        if (has_normals_)
          level_.normal.insert(level_.normal.end(), brick.normal[voxel].begin(), brick.normal[voxel].end());
        if (has_classes_) level_.voxel_class.push_back(brick.voxel_class[voxel]);
      }
    if (voxels == before) return;
    add_node(key, std::uint8_t(lod_), NodeKind::brick, std::uint32_t(level_.mask.size() / brick_edge), {0, 0},
             no_class);
    level_.mask.insert(level_.mask.end(), brick.mask.begin(), brick.mask.end());
    level_.first.push_back(voxels);
  }

  int lod_;
  LeafShape shape_;
  bool has_normals_, has_classes_;
  BrickLevel& level_;
  NodeTable nodes_;
};

}  // namespace

LeafShape leaf_shape_of(const SceneHeader& scene) {
  return scene.leaf_lod != 0 && parameters_from_json(scene.parameters).depth_error != 0 ? LeafShape::plane
                                                                                        : LeafShape::cube;
}

void expand_leaves(const std::vector<BrickLevel>& levels, int lod, LeafShape shape, NodeTable& nodes,
                   BrickLevel& level) {
  const bool has_normals = std::ranges::any_of(levels, [](const BrickLevel& l) { return !l.normal.empty(); });
  LeafExpander expander(lod, shape, has_normals, !nodes.voxel_class.empty(), level);
  expander.keep_nodes(nodes);
  for_each_leaf_octant(nodes, levels, lod, lod, [&](const LeafVoxels& leaves) { expander.add_octant(leaves); });
  nodes = expander.take_nodes();
}

std::uint64_t voxels_of_leaves(const NodeTable& nodes, const std::vector<BrickLevel>& above, int lod, LeafShape shape) {
  std::uint64_t voxels = 0;
  for_each_leaf_octant(nodes, above, lod + 1, lod, [&](const LeafVoxels& leaves) {
    const int coarser = leaves.lod - lod;
    for_each_leaf(leaves, [&](const Vec3<int>&, const std::uint8_t*, const std::int8_t* normal,
                              const std::uint8_t* coverage, VoxelClass) {
      const std::uint8_t plane = coverage == nullptr ? std::uint8_t(0) : coverage[directional_coverage_plane];
      if (is_cut(shape, coarser, plane))
        for_each_crossed(normal, plane, coarser, [&](const Vec3<int>&, std::uint8_t) { ++voxels; });
      else
        voxels += std::uint64_t(1) << 3 * coarser;
    });
  });
  return voxels;
}

}  // namespace gigabake
