/// Division of a scene into the tiles of one octree.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

#include "core/math/box3.h"
#include "format/scene/cell_window.h"
#include "format/scene/scene_level.h"

namespace gigabake {

/// A tile: its level in the tree (0 is the root) and its Morton code on this level (bit 3n is bit n of x).
struct TilePlace {
  std::uint32_t level = 0;
  std::uint64_t key = 0;
  friend auto operator<=>(const TilePlace&, const TilePlace&) = default;
};

inline constexpr std::uint32_t max_tile_levels = 21;  ///< bits per axis in a Morton code

/// The cube that the octree divides. A tile has `edge`³ voxels of one level of the lattice.
struct VoxelTiling {
  LevelIndex corner{};       ///< lowest corner in voxels of level 0, a multiple of the root's voxel edge
  std::uint32_t edge = 0;    ///< edge of a tile in voxels
  std::uint32_t levels = 0;  ///< number of tile levels
  int finest = 0;            ///< lod of the last level

  int lod(std::uint32_t level) const { return finest + int(levels - 1 - level); }
  std::uint32_t level(int lod) const { return levels - 1 - std::uint32_t(lod - finest); }
  int coarsest() const { return lod(0); }
  /// Returns the box of a tile in voxels of its level, plus a padding of one voxel, which interpolation needs.
  Box3i64 padded_box(const TilePlace& tile) const;
  /// Returns the positions of the level's tiles in which `voxels`, or their parents, are visible with interpolation.
  /// Parents are included because a viewer shows the coarser tile in place of a missing tile.
  Box3i64 tiles_near(int lod, const Box3i64& voxels) const;
  friend bool operator==(const VoxelTiling&, const VoxelTiling&) = default;
};

/// Converts a box of voxels of level `lod` to voxels of level 0.
Box3i64 on_lattice(const Box3i64& voxels, int lod);

/// Fits the octree to `bounds`, in voxels of level 0. The root is the smallest cube that contains `bounds`. `edge` is
/// the edge of tiles in voxels. If it is 0, selects the edge from 80 to 112 that gives the smallest cube, or a smaller
/// edge if one tile suffices.
/// Range   `bounds` is not empty. The result's `levels` may exceed max_tile_levels; the caller must check.
VoxelTiling tiling_of(const Box3i64& bounds, int finest, std::uint32_t edge);

/// Returns "LEVEL/X/Y/Z", as in the templates of implicit tilesets.
std::string path_of(const TilePlace& tile);

}  // namespace gigabake
