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

/// The max edge length, in bits, of a voxel's coverage mask (kernels/body/mip/directional_coverage.h).
inline constexpr int max_raster_edge = 8;
/// Returns the edge length, in bits, of a coverage mask on level `lod`.
GB_HD constexpr int raster_edge(int lod) { return lod < 3 ? 1 << lod : max_raster_edge; }
/// Returns the bytes of a voxel's three coverage masks. At lod 0 there are none: the alpha in `rgba` is the coverage.
GB_HD constexpr std::size_t raster_bytes(int lod) {
  return lod == 0 ? 0 : std::size_t(3 * raster_edge(lod) * raster_edge(lod));
}

/// Columns with one row per voxel of the coarsest level. If MipFilter::thesis reads two levels, the rows of the next
/// finer level follow. Rows of a level are sorted by the Morton code of their brick, then by x + 8y + 64z.
struct DownsampleState {
  /// The number of levels below the coarsest (0 or 1), then x, y and z in voxels of the row's level. The origin is the
  /// shard's lowest corner.
  std::vector<std::uint8_t> place;
  std::vector<std::uint8_t> rgba;   ///< 4 per voxel
  std::vector<std::int8_t> normal;  ///< 2 per voxel; empty if the channel is off
  /// raster_bytes() per voxel of the coarsest level; empty without MipFilter::coverage and at lod 0.
  std::vector<std::uint8_t> raster;
  /// Surface moments, 8 bytes per voxel of the coarsest level (kernels/body/mip/patch.h). Empty without
  /// MipFilter::coverage, without normals, and at lod 0 without planes.
  std::vector<std::uint8_t> patch;
  std::vector<VoxelClass> voxel_class = {};  ///< 1 per voxel; empty if the channel is off

  std::size_t voxels() const { return rgba.size() / 4; }
  bool empty() const { return rgba.empty(); }
  friend bool operator==(const DownsampleState&, const DownsampleState&) = default;
};

}  // namespace gigabake
