/// A cell's sparse voxel oct-tree in memory: what the kernels make and what a shard holds.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lattice/brick.h"

namespace gigabake {

/// What a voxel of lod 1 and up says of directions, a byte each: its coverage that views along x, y and z see; and the
/// plane that its surface lies on, if it is one sheet (kernels/body/plane.h).
inline constexpr std::size_t coverage_bytes = 3, facing_plane = 3, facing_bytes = 4;
using Facing = std::array<std::uint8_t, facing_bytes>;

/// Whether a voxel's plane can be this byte: 0 where there is none; else its offset plus 8 (1 to 15) above two bits for
/// how much of the surface lies on it (1 to 3).
constexpr bool is_plane(std::uint8_t byte) { return byte == 0 || (byte < 64 && (byte >> 2) != 0 && (byte & 3) != 0); }

enum class NodeKind : std::uint8_t {
  brick = 0,          ///< value: index of its brick in its level
  constant = 1,       ///< all 512 voxels are present and alike; children may differ in detail below. value: rgba
  leaf_constant = 2,  ///< as constant, and so is everything below: no children are stored. value: rgba
};

/// Oct-tree nodes, level by level from the root (lod = lods-1) to lod 0, Morton order within a level.
struct NodeTable {
  std::vector<std::uint64_t> key;  ///< Morton code (x lowest bit) of the brick in its level
  std::vector<std::uint8_t> lod;
  std::vector<NodeKind> kind;
  std::vector<std::uint8_t> child_mask;  ///< bit c: child c = x | y<<1 | z<<2 is stored
  std::vector<std::uint32_t>
      first_child;                   ///< node index of the lowest stored child; the others follow. 0xffffffff: none
  std::vector<std::uint32_t> value;  ///< brick index, or rgba as bytes r,g,b,a from the lowest
  std::vector<std::array<std::int8_t, 2>> normal;  ///< of constant nodes, octahedral; zero otherwise
  std::vector<Facing> facing;  ///< of constant nodes of lod 1 and up; empty where the channel is off
};

/// Packed bricks of one level, Morton order. Voxel (x,y,z) of a brick is bit x+8y of word z.
/// Voxels of a brick follow each other by rising bit number, words first.
struct BrickLevel {
  std::vector<std::uint64_t> mask;   ///< 8 per brick
  std::vector<std::uint64_t> first;  ///< bricks+1: where a brick's voxels start
  std::vector<std::uint8_t> rgba;    ///< 4 per voxel: sRGB colour, coverage
  std::vector<std::int8_t> normal;   ///< 2 per voxel: octahedral; empty where the channel is off
  /// facing_bytes per voxel. Empty at lod 0, where surface has no directions, and where the channel is off.
  std::vector<std::uint8_t> facing;
};

}  // namespace gigabake
