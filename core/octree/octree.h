/// A cell's sparse voxel octree in memory: the result of the kernels and the content of a shard.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/rules.h"
#include "core/octree/brick.h"

namespace gigabake {

/// The directional data of a voxel. The first three bytes are its directional coverage along x, y and z; at lod 0 they
/// are zero. Byte directional_coverage_plane is the plane of its surface, if the surface has one plane
/// (core/octree/plane.h).
inline constexpr std::size_t coverage_bytes = 3, directional_coverage_plane = 3, directional_coverage_bytes = 4;
using DirectionalCoverage = std::array<std::uint8_t, directional_coverage_bytes>;

/// Returns the directional data of a lod-0 voxel: its plane without coverages.
inline DirectionalCoverage finest_directional_coverage(const std::uint8_t directional_coverage[]) {
  return {0, 0, 0, directional_coverage[directional_coverage_plane]};
}

/// Returns true if `byte` is a valid plane. The value 0 means no plane. Otherwise the upper bits are the plane's offset
/// plus 8 (1 to 15). The lower two bits are the fraction of the surface on the plane (1 to 3).
constexpr bool is_plane(std::uint8_t byte) { return byte == 0 || (byte < 64 && (byte >> 2) != 0 && (byte & 3) != 0); }

/// The coarsest level whose voxels may end a branch within an error bound (BakeParameters::depth_error). All cells of
/// at least 32 voxels have it, and its octants are aligned in all of them.
inline constexpr int max_ended_lod = 2;

/// The class of a voxel: a number that a scene .json gives to sources, materials or ids in the data.
using VoxelClass = std::uint16_t;
inline constexpr VoxelClass no_class = 0;  ///< of content without a class
inline constexpr std::uint32_t max_class = 65535;

enum class NodeKind : std::uint8_t {
  brick = 0,          ///< value: the index of the brick in its level
  constant = 1,       ///< all 512 voxels exist and are equal; children may differ. value: rgba
  leaf_constant = 2,  ///< like constant, for all finer levels too: no children are stored. value: rgba
};

template <>
constexpr auto names_of<NodeKind>() {
  return std::to_array<std::string_view>({"brick", "constant", "leaf_constant"});
}

/// The octree's nodes: levels from the root (lod = lods-1) to lod 0, in Morton order within a level.
struct NodeTable {
  std::vector<std::uint64_t> key;  ///< Morton code (x lowest bit) of the brick in its level
  std::vector<std::uint8_t> lod;
  std::vector<NodeKind> kind;
  std::vector<std::uint8_t> child_mask;    ///< bit c: child c = x | y<<1 | z<<2 is stored
  std::vector<std::uint32_t> first_child;  ///< node index of the lowest stored child; siblings follow. 0xffffffff: none
  std::vector<std::uint32_t> value;        ///< brick index, or rgba as bytes r,g,b,a, lowest first
  std::vector<std::array<std::int8_t, 2>> normal;         ///< constant nodes: octahedral; others: zero
  std::vector<DirectionalCoverage> directional_coverage;  ///< constant nodes; empty if the channel is off. For lod-0
                                                          ///< voxels, only the plane applies
  bool has_finest_planes = false;                         ///< lod-0 voxels have planes
  /// Bit c: octant c of the node is a leaf. Its voxels exist and describe all finer levels; child c is not stored.
  /// Empty if no node has leaves, as in all scenes whose sources have one voxel size.
  std::vector<std::uint8_t> leaf_mask = {};
  std::vector<VoxelClass> voxel_class = {};  ///< constant nodes; others: no_class. Empty if the channel is off
};

/// The bricks of one level in Morton order. Voxel (x,y,z) of a brick is bit x+8y of word z. The voxels of a brick are
/// stored in ascending order of word, then bit.
struct BrickLevel {
  std::vector<std::uint64_t> mask;   ///< 8 per brick
  std::vector<std::uint64_t> first;  ///< bricks+1 entries: the index of each brick's first voxel
  std::vector<std::uint8_t> rgba;    ///< 4 per voxel: sRGB colour, coverage
  std::vector<std::int8_t> normal;   ///< 2 per voxel: octahedral; empty if the channel is off
  /// directional_coverage_bytes per voxel. Empty if the channel is off, and at lod 0 without planes.
  std::vector<std::uint8_t> directional_coverage;
  std::vector<VoxelClass> voxel_class = {};  ///< 1 per voxel; empty if the channel is off
};

}  // namespace gigabake
