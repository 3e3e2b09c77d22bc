/// What the levels above a shard are made of: its coarsest level as the filter knows it, before anything was made alike
/// or left out of the stored voxels. A level above so depends on the lattice alone, and not on where shards end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lattice/host_device.h"
#include "lattice/octree.h"

namespace gigabake {

/// Bytes of a row of each column.
inline constexpr std::size_t source_place_bytes = 4, source_patch_bytes = 8;

/// Cells along an edge of a voxel's raster on a level (kernels/body/facing.h).
inline constexpr int most_raster_edge = 8;
GB_HD constexpr int raster_edge(int lod) { return lod < 3 ? 1 << lod : most_raster_edge; }
/// Of its three rasters. At lod 0 the one cell is the voxel's alpha, and is not kept besides.
GB_HD constexpr std::size_t raster_bytes(int lod) {
  return lod == 0 ? 0 : std::size_t(3 * raster_edge(lod) * raster_edge(lod));
}

/// Columns, a row a voxel: those of the coarsest level first, and, with MipFilter::thesis, those of the level below it,
/// for it is from two levels below that this filter makes a level. In each by rising Morton code of the brick, then by
/// x + 8y + 64z in it.
struct ParentSource {
  std::vector<std::uint8_t>
      place;  ///< levels below the coarsest (0, 1); x, y, z in voxels of that level from its corner
  std::vector<std::uint8_t> rgba;   ///< 4 a voxel
  std::vector<std::int8_t> normal;  ///< 2 a voxel; empty where the channel is off
  /// raster_bytes() a voxel of the coarsest level; empty without MipFilter::coverage and at lod 0.
  std::vector<std::uint8_t> raster;
  std::vector<std::uint8_t>
      patch;  ///< 8 a voxel of the coarsest level (kernels/body/patch.h); empty without normals too

  std::size_t voxels() const { return rgba.size() / 4; }
  bool empty() const { return rgba.empty(); }
  friend bool operator==(const ParentSource&, const ParentSource&) = default;
};

}  // namespace gigabake
