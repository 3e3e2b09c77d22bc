/// The voxels of a whole scene for first-hit rays: a tree with 4×4×4 children per node, down to single voxels.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake::kernels {

inline constexpr int max_first_hit_bits = 18;  ///< log2 of a tree's edge; float coordinates then resolve 1/32 voxel

/// A node. Child (x, y, z) is bit x + 4y + 16z. Existing children are stored contiguously, in ascending order of their
/// bits.
struct alignas(16) FirstHitNode {
  std::uint64_t mask = 0;  ///< mask of the existing children
  std::uint32_t end = 0;   ///< index after the highest child's node, or after its attributes if the children are voxels
  std::uint32_t unused = 0;
};

/// The attributes of a voxel.
struct alignas(8) VoxelAttributes {
  std::uint32_t rgba = 0;      ///< sRGB colour and coverage; red in the lowest byte
  std::int8_t normal[2] = {};  ///< octahedral
  std::uint8_t plane = 0;      ///< of the surface (core/octree/plane.h); 0: none
  std::uint8_t coarser = 0;    ///< levels by which the voxel is coarser than the tree's: a leaf; 0: of the tree's level
};

/// A cube of 2^bits voxels per edge, centred on a box that contains all voxels.
struct FirstHitTree {
  Span<const FirstHitNode> nodes;  ///< [0] is the root; empty: no voxels
  double centre[3] = {};           ///< lod-0 voxels of the scene's lattice
  double half[3] = {};    ///< half extent of the box in units of the cube's edge; includes a margin of one voxel
  double per_edge = 0;    ///< 1 / edge
  float edge = 0;         ///< of the cube, lod-0 voxels; a power of two
  std::int32_t bits = 0;  ///< even, 2 to max_first_hit_bits
};

/// A dilated mip: a tree of coarser voxels around the same centre. It contains each coarse voxel that holds a voxel of
/// the scene, and the 26 neighbours of that coarse voxel. In the maximum norm, points outside the shell are farther
/// than `reach` from every voxel of the scene.
struct FirstHitShell {
  FirstHitTree tree;
  float reach = 0;  ///< edge of the shell's voxels, in lod-0 voxels
};

/// A scene that first-hit rays borrow.
struct FirstHitView {
  FirstHitTree tree;
  FirstHitShell shells[2];  ///< with coarse voxels of 4³ and of 16³ lod-0 voxels
  Span<const VoxelAttributes> attributes;
};

}  // namespace gigabake::kernels
