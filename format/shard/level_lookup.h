/// Finds single voxels of one level of a cell.
#pragma once

#include <cstdint>
#include <vector>

#include "format/shard/brick_walk.h"
#include "format/shard/shard.h"

namespace gigabake {

struct VoxelValue {
  const std::uint8_t* rgba;    ///< 4
  const std::int8_t* normal;   ///< 2; two zeros where the shard has no normals
  const std::uint8_t* facing;  ///< facing_bytes; null where the level has none
};

/// Borrows the nodes and the bricks of level `lod`.
/// Cost  a binary search per brick; voxels asked for brick by brick cost a few bit counts each.
class LevelLookup {
 public:
  LevelLookup(const NodeTable& nodes, const BrickLevel& level, std::uint32_t lods, int lod);

  /// x, y, z in voxels of the level from the cell's corner, inside the cell. False: no voxel there.
  bool find(std::uint32_t x, std::uint32_t y, std::uint32_t z, VoxelValue& value);

 private:
  static constexpr std::size_t no_node = ~std::size_t(0);
  std::size_t find_node(std::uint64_t key) const;

  const NodeTable& nodes_;
  const BrickLevel& level_;
  std::vector<LevelNodes> of_level_;
  int lod_;
  std::uint64_t key_ = ~std::uint64_t(0);  ///< whose node is `node_`
  std::size_t node_ = no_node;
  std::uint8_t constant_[4] = {};
};

}  // namespace gigabake
