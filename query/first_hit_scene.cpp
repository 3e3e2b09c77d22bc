#include "query/first_hit_scene.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "core/base/error.h"
#include "format/scene/expanded_leaves.h"
#include "format/scene/shard_of_scene.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/coarse_levels.h"
#include "query/first_hit_tree.h"

namespace gigabake {
namespace {

using kernels::FirstHitNode;
using kernels::VoxelAttributes;

constexpr std::uint64_t max_looks = 0xffffffffu;
constexpr std::int64_t max_constant_edge_in_shells = 64;
constexpr std::int64_t shell_rim = 17;  ///< voxels between the box and the cube's faces

void require(bool condition, const char* what) {
  if (!condition) throw std::invalid_argument(what);
}

std::length_error too_wide() {
  return std::length_error("2^" + std::to_string(kernels::max_first_hit_bits) +
                           " voxels an edge or more; use a coarser lod");
}

/// `directional_coverage` is null for a voxel without a plane.
VoxelAttributes look_of(const std::uint8_t rgba[4], const std::int8_t normal[2],
                        const std::uint8_t* directional_coverage) {
  VoxelAttributes voxel;
  for (int c = 0; c < 4; ++c) voxel.rgba |= std::uint32_t(rgba[c]) << 8 * c;
  voxel.normal[0] = normal[0];
  voxel.normal[1] = normal[1];
  if (directional_coverage != nullptr) voxel.plane = directional_coverage[directional_coverage_plane];
  return voxel;
}

void check_columns(const NodeTable& nodes, const BrickLevel& level) {
  const std::size_t count = nodes.key.size(), bricks = level.mask.size() / brick_edge;
  require(nodes.lod.size() == count && nodes.kind.size() == count && nodes.value.size() == count &&
              nodes.normal.size() == count && (nodes.voxel_class.empty() || nodes.voxel_class.size() == count),
          "the node table's columns differ in length");
  require(level.mask.size() == bricks * brick_edge && level.first.size() == bricks + 1 &&
              level.first[bricks] * 4 == level.rgba.size() &&
              (level.normal.empty() || level.normal.size() * 2 == level.rgba.size()) &&
              (level.voxel_class.empty() || level.voxel_class.size() * 4 == level.rgba.size()),
          "the level's columns do not match each other");
  for (std::size_t b = 0; b < bricks; ++b) {
    std::uint64_t voxels = 0;
    for (std::size_t z = 0; z < brick_edge; ++z) voxels += std::uint64_t(std::popcount(level.mask[brick_edge * b + z]));
    require(level.first[b + 1] - level.first[b] == voxels, "a brick's mask and voxels differ in number");
  }
}

kernels::FirstHitTree tree_around(const double centre[3], const double half_voxels[3], int bits, double voxel,
                                  const std::vector<FirstHitNode>& nodes) {
  kernels::FirstHitTree tree;
  const double edge = double(std::int64_t(1) << bits);
  for (int a = 0; a < 3; ++a) {
    tree.centre[a] = centre[a];
    tree.half[a] = half_voxels[a] / edge;
  }
  tree.nodes = {nodes.data(), nodes.size()};
  tree.edge = float(edge * voxel);
  tree.per_edge = 1 / (edge * voxel);
  tree.bits = bits;
  return tree;
}

}  // namespace

std::uint64_t FirstHitScene::tree_bytes() const {
  return (nodes.size() + shells[0].size() + shells[1].size()) * sizeof(FirstHitNode);
}

std::uint64_t FirstHitScene::bytes() const {
  return tree_bytes() + attributes.size() * sizeof(VoxelAttributes) + classes.size() * sizeof(VoxelClass);
}

void FirstHitBuilder::add_attributes(const VoxelAttributes& attributes, VoxelClass voxel_class, std::size_t count) {
  attributes_.insert(attributes_.end(), count, attributes);
  if (has_classes_) classes_.insert(classes_.end(), count, voxel_class);
}

void FirstHitBuilder::add_brick(const Position& at, const BrickLevel& level, std::size_t brick) {
  FirstHitNode octants[8];
  std::vector<VoxelAttributes> attributes[8];
  std::vector<VoxelClass> classes[8];
  for_each_voxel(
      level, brick, {0, 0, 0},
      [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal,
          const std::uint8_t* directional_coverage, VoxelClass voxel_class) {
        const std::size_t o = (x >> 2) | (y >> 2) << 1 | (z >> 2) << 2;
        octants[o].mask |= std::uint64_t(1) << ((x & 3) | (y & 3) << 2 | (z & 3) << 4);
        attributes[o].push_back(look_of(rgba, normal, directional_coverage));  // in the order of the node's children
        if (has_classes_) classes[o].push_back(voxel_class);
      });
  for (std::size_t o = 0; o < 8; ++o) {
    if (attributes[o].empty()) continue;
    attributes_.insert(attributes_.end(), attributes[o].begin(), attributes[o].end());
    classes_.insert(classes_.end(), classes[o].begin(), classes[o].end());
    octants[o].end = std::uint32_t(attributes_.size());
    leaves_.push_back(
        {{std::int32_t(at[0] / 4) + std::int32_t(o & 1), std::int32_t(at[1] / 4) + std::int32_t(o >> 1 & 1),
          std::int32_t(at[2] / 4) + std::int32_t(o >> 2)},
         octants[o]});
    voxels_ += attributes[o].size();
  }
}

/// Returns the corner of a cell.
FirstHitBuilder::Position FirstHitBuilder::corner_of(const Vec3i64& lattice_min) const {
  Position cell;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t apart = lattice_min[a] - first_corner_[a];
    cell[a] = apart / (std::int64_t(1) << lod_);
    require(apart % (std::int64_t(4) << lod_) == 0,
            "distances between cells are not multiples of four voxels of this lod");
    if (std::abs(cell[a]) >= std::int64_t(1) << kernels::max_first_hit_bits) throw too_wide();
  }
  return cell;
}

/// Adds an octant of voxels that are one level coarser than the tree's: eight nodes of 2×2×2 of them.
void FirstHitBuilder::add_half_bricks(const Position& at, const LeafOctant& octant) {
  for (int node = 0; node < 8; ++node) {
    Leaf leaf{{std::int32_t(at[0] / 4) + (node & 1), std::int32_t(at[1] / 4) + (node >> 1 & 1),
               std::int32_t(at[2] / 4) + (node >> 2)},
              {}};
    for (int child = 0; child < 64; ++child) {
      const int x = 2 * (node & 1) + (child & 3) / 2, y = 2 * (node >> 1 & 1) + (child >> 2 & 3) / 2,
                z = 2 * (node >> 2) + (child >> 4) / 2, of_leaf = x + 4 * y + 16 * z;
      if ((octant.mask >> of_leaf & 1) == 0) continue;
      leaf.node.mask |= std::uint64_t(1) << child;
      add_attributes(octant.attributes[std::size_t(of_leaf)], octant.classes[std::size_t(of_leaf)]);
    }
    if (leaf.node.mask == 0) continue;
    leaf.node.end = std::uint32_t(attributes_.size());
    leaves_.push_back(leaf);
  }
}

/// Adds an octant of voxels that are `coarser` levels coarser than the tree's, one constant node per voxel.
void FirstHitBuilder::add_cubes(const Position& at, const LeafOctant& octant, int coarser) {
  const std::int64_t edge = std::int64_t(1) << coarser;
  for (std::uint64_t rest = octant.mask; rest != 0; rest &= rest - 1) {
    const int voxel = std::countr_zero(rest);
    const Position corner = at + Position{voxel & 3, voxel >> 2 & 3, voxel >> 4} * edge;
    constants_.push_back({corner, edge, std::uint32_t(attributes_.size())});
    add_attributes(octant.attributes[std::size_t(voxel)], octant.classes[std::size_t(voxel)], 64);
  }
}

/// Adds an octant of leaves as voxels of the tree's level: those that their planes cross, or all of their cubes.
void FirstHitBuilder::add_crossed(const Position& at, const LeafOctant& octant, int coarser) {
  const int edge = 1 << coarser;  // voxels along an edge of a leaf, and nodes along an edge of the octant
  std::vector<std::array<VoxelAttributes, 64>> attributes(std::size_t(edge * edge * edge));
  std::vector<std::array<VoxelClass, 64>> classes(attributes.size());
  std::vector<std::uint64_t> mask(attributes.size());
  for (std::uint64_t rest = octant.mask; rest != 0; rest &= rest - 1) {
    const int leaf = std::countr_zero(rest);
    VoxelAttributes voxel = octant.attributes[std::size_t(leaf)];
    const auto set = [&](const Vec3<int>& in_leaf) {
      const Vec3<int> p = Vec3<int>{leaf & 3, leaf >> 2 & 3, leaf >> 4} * edge + in_leaf;
      const auto node = std::size_t((p[0] >> 2) + edge * ((p[1] >> 2) + edge * (p[2] >> 2)));
      const auto child = std::size_t((p[0] & 3) | (p[1] & 3) << 2 | (p[2] & 3) << 4);
      mask[node] |= std::uint64_t(1) << child;
      attributes[node][child] = voxel;
      classes[node][child] = octant.classes[std::size_t(leaf)];
    };
    if (is_cut(LeafShape::plane, coarser, voxel.plane)) {
      voxel.coarser = 0;
      for_each_crossed(octant.attributes[std::size_t(leaf)].normal, octant.attributes[std::size_t(leaf)].plane, coarser,
                       [&](const Vec3<int>& in_leaf, std::uint8_t plane) {
                         voxel.plane = plane;
                         set(in_leaf);
                       });
    } else {
      for (int i = 0; i < edge * edge * edge; ++i) set({i % edge, i / edge % edge, i / edge / edge});
    }
  }
  for (std::size_t node = 0; node < mask.size(); ++node) {
    if (mask[node] == 0) continue;
    for (std::uint64_t rest = mask[node]; rest != 0; rest &= rest - 1) {
      const auto child = std::size_t(std::countr_zero(rest));
      add_attributes(attributes[node][child], classes[node][child]);
    }
    const auto x = std::int32_t(node) % edge, y = std::int32_t(node) / edge % edge,
               z = std::int32_t(node) / edge / edge;
    leaves_.push_back({{std::int32_t(at[0] / 4) + x, std::int32_t(at[1] / 4) + y, std::int32_t(at[2] / 4) + z},
                       {mask[node], std::uint32_t(attributes_.size())}});
    voxels_ += std::uint64_t(std::popcount(mask[node]));
  }
}

void FirstHitBuilder::add_leaves(const Vec3i64& lattice_min, const NodeTable& nodes,
                                 const std::vector<BrickLevel>& levels, LeafShape shape) {
  const Position cell = corner_of(lattice_min);
  for_each_leaf_octant(nodes, levels, lod_, lod_, [&](const LeafVoxels& leaf) {
    LeafOctant octant;
    const int coarser = leaf.lod - lod_;
    for_each_leaf(leaf, [&](const Vec3<int>& at, const std::uint8_t* rgba, const std::int8_t* normal,
                            const std::uint8_t* directional_coverage, VoxelClass voxel_class) {
      const int voxel = at[0] + 4 * at[1] + 16 * at[2];
      octant.mask |= std::uint64_t(1) << voxel;
      octant.attributes[std::size_t(voxel)] = look_of(rgba, normal, directional_coverage);
      octant.attributes[std::size_t(voxel)].coarser = std::uint8_t(coarser);
      octant.classes[std::size_t(voxel)] = voxel_class;
    });
    if (attributes_.size() + brick_voxels * brick_edge > max_looks)
      throw std::length_error("2^32 voxels or more; use a coarser lod");
    const Position at = cell + leaf.octant * (std::int64_t(brick_edge / 2) << coarser);
    if (shape == LeafShape::plane && coarser <= max_ended_lod) return add_crossed(at, octant, coarser);
    if (coarser == 1)
      add_half_bricks(at, octant);
    else
      add_cubes(at, octant, coarser);
    voxels_ += std::uint64_t(std::popcount(octant.mask)) << 3 * coarser;
  });
}

void FirstHitBuilder::add_cell(const Vec3i64& lattice_min, const NodeTable& nodes, const BrickLevel& level) {
  check_columns(nodes, level);
  if (empty_) first_corner_ = lattice_min, has_classes_ = !nodes.voxel_class.empty();
  empty_ = false;
  const Position cell = corner_of(lattice_min);
  for (std::size_t n = 0; n < nodes.key.size(); ++n) {
    if (nodes.lod[n] < lod_ || (nodes.lod[n] > lod_ && nodes.kind[n] != NodeKind::leaf_constant)) continue;
    const std::int64_t edge = std::int64_t(brick_edge) << (nodes.lod[n] - lod_);
    const Position at = cell + Position(demorton(nodes.key[n])) * edge;
    if (attributes_.size() + brick_voxels > max_looks)
      throw std::length_error("2^32 voxels or more; use a coarser lod");
    if (nodes.kind[n] == NodeKind::brick) {
      require(nodes.value[n] < level.mask.size() / brick_edge, "a node's brick is out of range");
      add_brick(at, level, nodes.value[n]);
      continue;
    }
    std::uint8_t rgba[4];
    for (int c = 0; c < 4; ++c) rgba[c] = std::uint8_t(nodes.value[n] >> 8 * c);
    constants_.push_back({at, edge, std::uint32_t(attributes_.size())});
    DirectionalCoverage finest;
    const std::uint8_t* directional_coverage = directional_coverage_of_constant(nodes, n, lod_ == 0, finest);
    add_attributes(look_of(rgba, nodes.normal[n].data(), directional_coverage), class_of_constant(nodes, n), 64);
    voxels_ += std::uint64_t(edge * edge * edge);
  }
}

FirstHitBuilder::Cube FirstHitBuilder::cube_of_voxels() const {
  Cube cube;
  std::int64_t maximum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    std::int64_t low = INT64_MAX, high = INT64_MIN;
    for (const Leaf& leaf : leaves_) {
      low = std::min(low, std::int64_t(leaf.at[a]) * 4);
      high = std::max(high, std::int64_t(leaf.at[a]) * 4 + 4);
    }
    for (const Constant& constant : constants_) {
      low = std::min(low, constant.at[a]);
      high = std::max(high, constant.at[a] + constant.edge);
    }
    const std::int64_t centre = (low + high) / 2 / 4 * 4;
    cube.corner[a] = centre;
    cube.half[a] = std::max(high - centre, centre - low) + 1;
    maximum = std::max(maximum, cube.half[a] + shell_rim);
  }
  while (maximum > std::int64_t(1) << (cube.bits - 1)) cube.bits += 2;
  if (cube.bits > kernels::max_first_hit_bits) throw too_wide();
  for (std::int64_t& corner : cube.corner) corner -= std::int64_t(1) << (cube.bits - 1);
  return cube;
}

FirstHitBuilder::Cube FirstHitBuilder::cube_of_window(std::int64_t edge) {
  Cube cube;
  cube.half = Position::all(edge / 2 + 1);
  while (cube.half[0] > std::int64_t(1) << (cube.bits - 1)) cube.bits += 2;
  if (cube.bits > kernels::max_first_hit_bits) throw too_wide();
  cube.corner = Position::all(edge / 2 - (std::int64_t(1) << (cube.bits - 1)));
  return cube;
}

std::vector<FirstHitNode> FirstHitBuilder::build_nodes(const Cube& cube) {
  FirstHitTreeBuilder tree(cube.bits);
  for (const Leaf& leaf : leaves_)
    tree.add({leaf.at[0] - std::int32_t(cube.corner[0] / 4), leaf.at[1] - std::int32_t(cube.corner[1] / 4),
              leaf.at[2] - std::int32_t(cube.corner[2] / 4)},
             leaf.node);
  leaves_ = {};
  for (const Constant& constant : constants_) {
    Position low, high;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = constant.at[a] - cube.corner[a];
      high[a] = low[a] + constant.edge;
    }
    tree.add_constant(low, high, constant.attributes_index);
  }
  return tree.finish();
}

FirstHitScene FirstHitBuilder::place_tree(const Cube& cube) {
  FirstHitScene scene;
  scene.lod = lod_;
  scene.voxels = voxels_;
  scene.nodes = build_nodes(cube);
  scene.attributes = std::move(attributes_);
  scene.classes = std::move(classes_);
  const std::int64_t voxel = std::int64_t(1) << lod_;
  double centre[3], half[3];
  for (std::size_t a = 0; a < 3; ++a) {
    scene.lattice_min[a] = first_corner_[a] + cube.corner[a] * voxel;
    centre[a] = double(scene.lattice_min[a]) + double(voxel << (cube.bits - 1));
    half[a] = double(cube.half[a]);
  }
  scene.view.tree = tree_around(centre, half, cube.bits, double(voxel), scene.nodes);
  scene.view.attributes = {scene.attributes.data(), scene.attributes.size()};
  return scene;
}

void FirstHitBuilder::add_shells(const Cube& cube, FirstHitScene& scene) {
  const auto voxel = double(std::int64_t(1) << scene.lod);
  for (std::size_t s = 0; s < 2; ++s) {
    scene.shells[s] = make_shell(scene.nodes, cube.bits, int(s) + 1);
    const int bits = int(2 * s) + 2;
    const double reach = double(1 << bits), rim = 1;  // in voxels of the tree; in voxels of the shell
    double wider[3];
    for (std::size_t a = 0; a < 3; ++a) wider[a] = double(cube.half[a]) / reach + rim;
    scene.view.shells[s].tree =
        tree_around(scene.view.tree.centre, wider, cube.bits - bits, voxel * reach, scene.shells[s]);
    scene.view.shells[s].reach = float(voxel * reach);
  }
}

FirstHitScene FirstHitBuilder::finish() {
  if (leaves_.empty() && constants_.empty()) {
    FirstHitScene scene;
    scene.lod = lod_;
    return scene;
  }
  std::int64_t maximum = 0;
  for (const Constant& constant : constants_) maximum = std::max(maximum, constant.edge);
  const Cube cube = cube_of_voxels();
  FirstHitScene scene = place_tree(cube);
  if (maximum <= max_constant_edge_in_shells) add_shells(cube, scene);
  return scene;
}

FirstHitScene FirstHitBuilder::finish_window(std::int64_t window_voxels) {
  require(window_voxels >= brick_edge && window_voxels % brick_edge == 0,
          "the window does not consist of whole bricks");
  if (leaves_.empty() && constants_.empty()) return finish();
  return place_tree(cube_of_window(window_voxels));
}

FirstHitScene build_first_hit_scene(const SceneDescription& scene, const std::filesystem::path& scene_path, int lod) {
  FirstHitBuilder builder(lod);
  try {
    for (const SceneCell& cell : scene.cells) {
      if (lod < 0 || lod >= int(cell.lods)) throw std::invalid_argument("no lod " + std::to_string(lod));
      const ShardReader shard = open_shard_of_scene(scene_path, scene, cell);
      builder.add_cell(cell.lattice_min, shard.nodes(), shard.level(lod));
      if (shard.header().leaf_lod <= std::uint32_t(lod)) continue;
      const CoarseLevels coarse = shard.coarse_levels(lod);
      builder.add_leaves(cell.lattice_min, coarse.nodes, coarse.levels, leaf_shape_of(scene));
    }
    return builder.finish();
  } catch (const std::invalid_argument& error) {
    throw InputError(scene_path, "", error.what());
  } catch (const std::length_error& error) {
    throw InputError(scene_path, "", error.what());
  }
}

}  // namespace gigabake
