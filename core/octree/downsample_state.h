/// The input of the overview levels above a shard: its coarsest level before quantization and before voxels are
/// omitted. The overviews therefore depend only on the lattice, not on the boundaries of shards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/host_device.h"
#include "core/octree/octree.h"

namespace gigabake {

/// The row sizes of the columns, in bytes.
inline constexpr std::size_t source_place_bytes = 4, source_patch_bytes = 8;

/// Returns the edge length, in bits, of a voxel's coverage mask on a level (kernels/body/mip/facing.h).
inline constexpr int max_raster_edge = 8;
GB_HD constexpr int raster_edge(int lod) { return lod < 3 ? 1 << lod : max_raster_edge; }
/// Returns the size of a voxel's three masks. At lod 0 the only value is the voxel's alpha, which `rgba` already holds.
GB_HD constexpr std::size_t raster_bytes(int lod) {
  return lod == 0 ? 0 : std::size_t(3 * raster_edge(lod) * raster_edge(lod));
}

/// Columns with one row per voxel of the coarsest level. MipFilter::thesis reads two levels; if it is used, the rows of
/// the next finer level follow. Rows of a level are sorted by the Morton code of their brick, then by x + 8y + 64z.
struct DownsampleState {
  std::vector<std::uint8_t>
      place;  ///< levels below the coarsest (0, 1); x, y, z in voxels of that level from its corner
  std::vector<std::uint8_t> rgba;   ///< 4 per voxel
  std::vector<std::int8_t> normal;  ///< 2 per voxel; empty if the channel is off
  /// raster_bytes() per voxel of the coarsest level; empty without MipFilter::coverage and at lod 0.
  std::vector<std::uint8_t> raster;
  std::vector<std::uint8_t>
      patch;  ///< 8 a voxel of the coarsest level (kernels/body/mip/patch.h); empty without normals too

  std::size_t voxels() const { return rgba.size() / 4; }
  bool empty() const { return rgba.empty(); }
  friend bool operator==(const DownsampleState&, const DownsampleState&) = default;
};

}  // namespace gigabake
