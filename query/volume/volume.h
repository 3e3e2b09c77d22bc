/// Volumes between the surface of a scene and a height, or the surface of another scene, in an area.
///
/// The area is divided into vertical columns as wide as the finest voxels. The difference of heights in the middle of a
/// column is multiplied by the column's cross-section. surface_height.h defines the heights.
/// Exact   Differences are rounded to 2^-20 m and summed as integers. The result does not depend on the number of
///         threads, on batches or on memory. Cut and fill swap exactly if the two scenes swap.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/progress.h"
#include "format/area/area.h"
#include "query/scene_query.h"

namespace gigabake {

struct VolumeJob {
  std::shared_ptr<const Area> area;  ///< polygons
  int lod = 0;                       ///< the finest level of the queries, which sets the width of columns
  /// The height above the ellipsoid with which the surface is compared; nullopt: the surface of another scene.
  std::optional<double> above_m;
  std::size_t batch_columns = std::size_t(1) << 17;
};

/// Numbers of columns whose centres are in the area.
struct VolumeColumns {
  std::uint64_t measured = 0;
  std::uint64_t without_surface = 0;  ///< no surface in one of the scenes
  std::uint64_t outside = 0;          ///< outside the box around all cells of one of the scenes
  std::uint64_t missing = 0;          ///< the highest surface may lie in a missing cell of one of the scenes

  std::uint64_t all() const { return measured + without_surface + outside + missing; }
};

/// The sums over all measured columns.
/// Range   If columns are missing, the sums lack them and are no volumes of the area.
struct Volume {
  double column_m = 0;  ///< width of a column
  VolumeColumns columns;
  double cut_m3 = 0;   ///< above the height or above the other scene: material to remove
  double fill_m3 = 0;  ///< below the height or below the other scene: material to add
  /// The maximum errors. Heights contribute half a voxel of each scene in each column that may be cut or filled. The
  /// outline of the area contributes the columns that it cuts.
  double cut_error_m3 = 0, fill_error_m3 = 0;

  double area_m2() const { return double(columns.measured) * column_m * column_m; }
};

/// Measures the volume between `scene` and a height (`other` is null) or `other`. The scene with the smaller voxels
/// defines the columns. A scene with another origin is hit along the same lines.
/// Range   Both queries have the level of the job, and both scenes have an origin. The two queries are different.
/// Errors  UsageError: the errors of ColumnArea; the area contains no centre of a column; the area and the scenes have
///         no column in common. The errors of SceneQuery::first_hits().
Volume measure_volume(const VolumeJob& job, SceneQuery& scene, SceneQuery* other, const ThreadPool& pool,
                      const Progress& progress = {});

}  // namespace gigabake
