/// The vertical columns of a scene whose centres are in an area.
///
/// Space   Columns are along the scene's z axis. Column x, y of level `lod` covers the voxels x, y of this level.
/// Exact   A column is inside if its centre on the plane z = 0 of the scene, through the scene's origin, is in the area
///         (format/area/area_in_scene.h).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/math/snap.h"
#include "format/area/area_in_scene.h"
#include "format/scene/xml/scene_xml.h"
#include "kernels/marching/voxel_space.h"

namespace gigabake {

/// The centre of a column that is inside.
struct AreaColumn {
  double x_m = 0, y_m = 0;
  bool is_at_outline = false;  ///< one of the four adjacent columns is outside
};

class ColumnArea {
 public:
  /// The number of columns along an edge of a block.
  static constexpr std::int64_t block_edge = 64;
  /// The lowest column of a block of block_edge × block_edge columns.
  using Block = std::array<std::int64_t, 2>;

  /// `window` is the bounding box of the scene's cells.
  /// Range   The scene has an origin, and the area has polygons and no bounds.
  /// Errors  UsageError: the area reaches farther beyond the window than the window is wide, and than 4096 columns.
  ColumnArea(std::shared_ptr<const Area> area, const SceneHeader& scene, const kernels::VoxelBox& window, int lod);

  double column_m() const { return column_m_; }

  /// Calls `visit` with blocks that contain all columns inside, except for the columns of blocks that lie in the area
  /// and outside the window. Returns the number of these columns.
  std::uint64_t for_each_block(const std::function<void(const Block&)>& visit) const;
  /// Returns the columns of a block that are inside, row by row.
  std::vector<AreaColumn> columns_in(const Block& block) const;

 private:
  std::uint64_t visit_blocks(const Block& min, std::int64_t edge, const std::function<void(const Block&)>& visit) const;
  AreaOverlap overlap(const Block& min, std::int64_t edge) const;
  double centre_m(std::size_t axis, std::int64_t column) const;
  bool is_outside_window(const Block& min, std::int64_t edge) const;

  SnapFrame frame_;
  double column_m_;
  AreaInScene area_;
  std::array<std::int64_t, 2> window_min_{}, window_end_{};  ///< columns
  std::array<std::int64_t, 2> min_{}, end_{};                ///< columns that contain the area
};

}  // namespace gigabake
