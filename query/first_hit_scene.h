/// A whole scene for first-hit rays, built once from its shards.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/math/vec3.h"
#include "format/scene/xml/scene_xml.h"
#include "format/shard/levels/leaf_walk.h"
#include "format/shard/shard.h"
#include "query/first_hit/first_hit_tree.h"

namespace gigabake {

/// The tree, shells and voxel attributes of a scene.
struct FirstHitScene {
  FirstHitScene() = default;
  FirstHitScene(FirstHitScene&&) = default;  // a copy's view would borrow from the original
  FirstHitScene& operator=(FirstHitScene&&) = default;

  std::vector<kernels::FirstHitNode> nodes;
  std::array<std::vector<kernels::FirstHitNode>, 2> shells;  ///< empty if a constant node is wider than 64 voxels
  std::vector<kernels::VoxelAttributes> attributes;          ///< one per voxel, and 64 per constant node
  std::vector<VoxelClass> classes;                           ///< one per entry of `attributes`; empty without classes
  kernels::FirstHitView view;                                ///< borrows the arrays above
  Vec3i64 lattice_min{};                                     ///< lod-0 voxel at the tree's lowest corner
  int lod = 0;                                               ///< level of the tree's voxels
  std::uint64_t voxels = 0;

  std::uint64_t tree_bytes() const;  ///< nodes and shells, without `attributes`
  std::uint64_t bytes() const;
};

/// A builder of a scene from cells that are added in any order.
class FirstHitBuilder {
 public:
  /// Takes the level of the voxels that the scene stores.
  explicit FirstHitBuilder(int lod) : lod_(lod) {}

  /// Adds a cell. `level` contains the cell's bricks of the builder's lod.
  /// Errors  std::invalid_argument: columns of inconsistent length, or a corner that is off the grid of the cells.
  ///         Corners differ by multiples of four voxels of the builder's lod.
  ///         std::length_error: 2^32 voxels or more.
  void add_cell(const Vec3i64& lattice_min, const NodeTable& nodes, const BrickLevel& level);

  /// Adds the leaves of a cell that are coarser than the builder's lod. They become cubes of their size, or voxels of
  /// the builder's lod that their planes cross. `levels` are the cell's levels from the builder's lod on.
  /// Errors  The errors of add_cell(), which was called for the cell before.
  void add_leaves(const Vec3i64& lattice_min, const NodeTable& nodes, const std::vector<BrickLevel>& levels,
                  LeafShape shape);

  /// Returns the scene.
  /// Errors  std::length_error: an edge of 2^18 voxels or more.
  FirstHitScene finish();
  /// Returns the scene of one cell. The tree covers the cell's whole window instead of the bounds of its voxels, and
  /// has no shells. `window_voxels` is the edge of the window in voxels of the builder's lod, a multiple of 8.
  FirstHitScene finish_window(std::int64_t window_voxels);

 private:
  using Position = Vec3i64;  ///< in voxels of lod_ from the first cell's corner
  /// The voxels of an octant, by x + 4y + 16z.
  struct LeafOctant {
    std::uint64_t mask = 0;
    std::array<kernels::VoxelAttributes, 64> attributes;
    std::array<VoxelClass, 64> classes{};
  };

  struct Leaf {
    std::array<std::int32_t, 3> at;  ///< in nodes of 4×4×4 voxels
    kernels::FirstHitNode node;
  };
  struct Constant {
    Position at;
    std::int64_t edge;
    std::uint32_t attributes_index;
  };
  /// The cube of the root.
  struct Cube {
    Position corner, half;  ///< lowest corner of the cube; half extent of the box that contains the voxels
    int bits = 6;
  };

  Position corner_of(const Vec3i64& lattice_min) const;
  void add_brick(const Position& at, const BrickLevel& level, std::size_t brick);
  void add_half_bricks(const Position& at, const LeafOctant& octant);
  void add_crossed(const Position& at, const LeafOctant& octant, int coarser);
  void add_cubes(const Position& at, const LeafOctant& octant, int coarser);
  Cube cube_of_voxels() const;
  static Cube cube_of_window(std::int64_t edge);
  std::vector<kernels::FirstHitNode> build_nodes(const Cube& cube);
  FirstHitScene place_tree(const Cube& cube);
  /// Appends the attributes and class of `count` voxels.
  void add_attributes(const kernels::VoxelAttributes& attributes, VoxelClass voxel_class, std::size_t count = 1);
  static void add_shells(const Cube& cube, FirstHitScene& scene);

  int lod_;
  bool empty_ = true;
  Vec3i64 first_corner_{};
  std::vector<Leaf> leaves_;
  std::vector<Constant> constants_;
  std::vector<kernels::VoxelAttributes> attributes_;
  bool has_classes_ = false;  ///< of the cells so far
  std::vector<VoxelClass> classes_;
  std::uint64_t voxels_ = 0;
};

/// Builds the scene from its shards.
/// Cost    Reads the node table and one level of every cell. Uses 16 bytes per nonempty block of 4×4×4 voxels (48
///         during the build), and 8 bytes per voxel.
/// Errors  InputError: a cell lacks the lod; the errors of FirstHitBuilder; shards that cannot be read.
FirstHitScene build_first_hit_scene(const SceneDescription& scene, const std::filesystem::path& scene_path, int lod);

}  // namespace gigabake
