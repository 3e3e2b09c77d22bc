/// The voxels of a whole scene as first-hit rays read them: a tree of 4×4×4 children a node, down to single voxels.
#pragma once

#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake::kernels {

inline constexpr int most_first_hit_bits = 18;  ///< of a tree's edge: its float coordinates then resolve 1/32 voxel

/// Child (x, y, z) is bit x + 4y + 16z. The children that exist follow each other by rising bit number.
struct alignas(16) FirstHitNode {
  std::uint64_t mask = 0;  ///< which children exist
  std::uint32_t end = 0;   ///< one behind the highest child's node; where the children are voxels, behind its look
  std::uint32_t unused = 0;
};

/// What a voxel looks like.
struct alignas(8) FirstHitLook {
  std::uint32_t rgba = 0;      ///< sRGB colour and coverage, bytes from the lowest
  std::int8_t normal[2] = {};  ///< octahedral
  std::int8_t unused[2] = {};
};

/// A cube of 2^bits voxels an edge around a box that holds every voxel; the box is centred in it.
struct FirstHitTree {
  Span<const FirstHitNode> nodes;  ///< [0] is the root; empty: nothing is there
  double centre[3] = {};           ///< lod-0 voxels of the scene's lattice
  double half[3] = {};             ///< of the box, a voxel wider than it must be; in cubes
  double per_edge = 0;             ///< 1 / edge
  float edge = 0;                  ///< of the cube, lod-0 voxels; a power of two
  std::int32_t bits = 0;           ///< even, 2 to most_first_hit_bits
};

/// A tree of coarser voxels, around the same centre: each that holds a voxel of the scene, and its 26 neighbours. What
/// is not in the shell is farther from every voxel than `reach` along some axis.
struct FirstHitShell {
  FirstHitTree tree;
  float reach = 0;  ///< lod-0 voxels: an edge of the shell's
};

/// A scene as first-hit rays borrow it.
struct FirstHitView {
  FirstHitTree tree;
  FirstHitShell shells[2];  ///< of 4³ and of 16³ voxels
  Span<const FirstHitLook> looks;
};

}  // namespace gigabake::kernels
