/// What one tile covers, per lattice column: found from positions alone, gathered on rank 0, input of the plan.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/shard/shard.h"
#include "format/source/source_warning.h"
#include "format/system/file_stamp.h"

namespace gigabake {

/// Raised whenever survey_tile() would give another answer for the same files, or TileSurvey has other fields: surveys
/// that were kept from earlier bakes are then made anew.
inline constexpr std::uint32_t survey_version = 6;

/// A triangle whose box has a longer side, voxels, is left out: exact arithmetic ends there (decision 151).
inline constexpr std::int64_t longest_side_voxels = 4186112;

/// One column of N×N voxels that a tile's triangles touch.
struct ColumnExtent {
  std::int64_t column_x = 0, column_y = 0;  ///< column index: floor(voxel / cell_voxels)
  std::int64_t z_min = 0, z_end = 0;  ///< lod-0 voxel range [z_min, z_end) that holds every voxel of the tile here
  std::uint64_t triangles = 0;        ///< triangles that may touch the column
  /// About how many lod-0 voxels its surface crosses, times crossing_unit: the triangles' areas as seen along x, y and
  /// z, added; a triangle's is shared evenly by its columns. Where surfaces lie close together fewer voxels are made.
  std::uint64_t crossings = 0;
};

/// Twice the area, in squared sub-voxels, of a voxel's face.
inline constexpr double crossing_unit = 2.0 * 256 * 256;

struct TileSurvey {
  std::uint32_t tile = 0;             ///< index into SceneSources::tiles
  std::vector<ColumnExtent> columns;  ///< sorted by (column_x, column_y), unique
  std::uint64_t triangles = 0;        ///< with instances, all that the file holds
  std::uint64_t non_finite = 0;       ///< triangles dropped: a vertex is NaN/Inf
  std::uint64_t too_far = 0;          ///< triangles left out: they reach farther than can be baked
  std::uint64_t zero_area = 0;        ///< triangles dropped: no area, in the source or after the snap; those of
                                      ///< primitives that were surveyed by boxes are not looked for
  std::uint64_t skipped_points = 0, skipped_lines = 0;
  Hash128 source;                       ///< tile_hash() of what was surveyed
  std::string error;                    ///< one line; not empty: the tile could not be read and has no columns
  std::vector<StampedFile> files = {};  ///< what tile_hash() read, as it was before anything was read
  /// Largest distance in the scene, over the tile's vertices, between neighbouring positions that its file could say.
  double spacing_m = 0;
  std::vector<SourceWarning> warnings = {};  ///< TileMesh::warnings
  double reach_m = 0;                        ///< longest side of the boxes of triangles that are too_far
};

}  // namespace gigabake
