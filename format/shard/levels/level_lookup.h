/// Lookup of single voxels in one level of a cell.
#pragma once

#include <cstdint>
#include <vector>

#include "format/shard/levels/brick_walk.h"
#include "format/shard/shard.h"

namespace gigabake {

struct VoxelValue {
  const std::uint8_t* rgba;   ///< 4 bytes
  const std::int8_t* normal;  ///< 2 bytes; two zeros if the shard has no normals
  const std::uint8_t*
      directional_coverage;  ///< directional_coverage_bytes; null if the level has no directional coverage
  VoxelClass voxel_class = no_class;
};

/// Lookup by coordinates. Borrows the nodes and the bricks of level `lod`.
/// Cost    The first lookup in a brick takes a binary search per level, from `lod` to the level of the node. Further
///         lookups in the same brick take a few bit counts each.
class LevelLookup {
 public:
  LevelLookup(const NodeTable& nodes, const BrickLevel& level, std::uint32_t lods, int lod);

  /// Sets `value` to the voxel at (x, y, z). Returns false if the level has no voxel there.
  /// Space   x, y and z are in voxels of the level, relative to the cell's lowest corner.
  /// Range   (x, y, z) lies inside the cell.
  bool find(std::uint32_t x, std::uint32_t y, std::uint32_t z, VoxelValue& value);

 private:
  static constexpr std::size_t no_node = ~std::size_t(0);
  std::size_t find_node(std::uint64_t key) const;

  const NodeTable& nodes_;
  const BrickLevel& level_;
  std::vector<LevelNodes> of_level_;
  int lod_;
  std::uint64_t key_ = ~std::uint64_t(0);  ///< Morton key whose node is `node_`
  std::size_t node_ = no_node;
  std::uint8_t constant_[4] = {};
  DirectionalCoverage finest_{};  ///< of a constant node, for lod-0 voxels
};

}  // namespace gigabake
