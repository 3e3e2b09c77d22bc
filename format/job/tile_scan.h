/// The result of scanning one tile: its extent per lattice column, from positions only. Rank 0 collects the scans to
/// make the plan.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/math/box3.h"
#include "format/shard/shard.h"
#include "format/source/source_warning.h"
#include "format/system/file_stamp.h"

namespace gigabake {

/// The version of a scan. Increment it if scan_tile() returns another result for the same files, or if the fields of
/// TileScan change. Stored scans of earlier bakes are then discarded.
inline constexpr std::uint32_t scan_version = 9;

/// Max side of a triangle's box in voxels. Triangles with a longer side are omitted, because the arithmetic would not
/// be exact (decision 151).
inline constexpr std::int64_t max_side_voxels = 4186112;

/// One column of N×N voxels that a tile's triangles overlap.
struct ColumnExtent {
  std::int64_t column_x = 0, column_y = 0;  ///< column index: floor(voxel / cell_voxels)
  std::int64_t z_min = 0, z_end = 0;  ///< lod-0 voxel range [z_min, z_end) that contains all voxels of the tile in this
                                      ///< column
  std::uint64_t triangles = 0;        ///< triangles that may overlap the column
  /// Approximate number of projected voxels of the tile's surface in this column, times projected_voxel_unit. A
  /// triangle counts voxels of its level (lod_of()). The number is the sum of the triangles' areas projected along x, y
  /// and z. The areas of a triangle are divided evenly among its columns. If surfaces are close together, they occupy
  /// fewer voxels.
  std::uint64_t projected_voxels = 0;
};

/// The doubled area of a voxel's face, in squared sub-voxels.
inline constexpr double projected_voxel_unit = 2.0 * 256 * 256;

struct TileScan {
  std::uint32_t tile = 0;             ///< index into SceneSources::tiles
  std::vector<ColumnExtent> columns;  ///< sorted by (column_x, column_y), unique
  Box3i64 bounds;                     ///< lod-0 voxels that contain all voxels of the tile; empty if it has none
  std::uint64_t triangles = 0;        ///< all triangles of the file, including instances
  std::uint64_t non_finite = 0;       ///< triangles dropped: a vertex is NaN/Inf
  std::uint64_t too_far = 0;          ///< triangles omitted: they extend too far to be baked
  std::uint64_t zero_area = 0;        ///< triangles dropped: no area, in the source or after the snap; not counted for
                                      ///< primitives that were scanned by their boxes
  std::uint64_t skipped_points = 0, skipped_lines = 0;
  Hash128 source;                       ///< tile_hash() of the scanned tile
  std::string error;                    ///< one line; if not empty, the tile could not be read and has no columns
  std::vector<StampedFile> files = {};  ///< files read by tile_hash(), with stamps from before reading
  /// Max coordinate resolution over the tile's vertices: the distance, in scene metres, between neighbouring positions
  /// that the file can represent.
  double spacing_m = 0;
  std::vector<SourceWarning> warnings = {};    ///< TileMesh::warnings
  double reach_m = 0;                          ///< max side of the boxes of triangles counted in too_far
  std::vector<std::uint32_t> classified = {};  ///< TileMesh::classified
  std::vector<std::uint32_t> sized = {};       ///< TileMesh::sized
  bool is_refused = false;                     ///< `error` is a UsageError: the scene does not fit the tile
};

}  // namespace gigabake
