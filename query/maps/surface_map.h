/// Heights, colours or classes of a scene seen from above, for the pixels of a map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/progress.h"
#include "core/base/thread_pool.h"
#include "format/area/area_in_scene.h"
#include "query/maps/map_frame.h"
#include "query/scene_query.h"

namespace gigabake {

/// A grid of square pixels. Column 0 is the western one, row 0 the northern one.
struct MapGrid {
  double west = 0, south = 0, step = 0;  ///< the edges of the outer pixels, and the edge of a pixel
  std::uint32_t columns = 0, rows = 0;

  /// Returns the coordinates of a pixel's centre. They are the points of grid_queries() for a box that begins at the
  /// centre of the south-western pixel, bit by bit.
  double x(std::uint32_t column) const { return (west + step / 2) + double(column) * step; }
  double y(std::uint32_t row) const { return (south + step / 2) + double(rows - 1 - row) * step; }
  double north() const { return south + double(rows) * step; }
};

/// Returns the grid of a box. `is_exact`: the grid begins at the box's corner; else the edges of pixels are multiples
/// of `step`. Contains the pixels whose centres are in the half-open box, at least one.
/// Errors  UsageError: the box is empty, or has more than 2^31 - 1 pixels along an axis.
MapGrid grid_of(const MapBox& box, double step, bool is_exact);

enum class MapContent : std::uint8_t {
  heights,  ///< float: the height of the surface as a height query returns it; NaN without a surface
  colours,  ///< red, green, blue (sRGB) and coverage, one byte each; zero without a surface
  classes   ///< int32: the class of the highest voxel; −1 without a surface
};

struct MapJob {
  MapContent content = MapContent::heights;
  MapGrid grid;
  std::uint32_t block = 512;                          ///< the edge of a block in pixels
  std::size_t batch_rays = std::size_t(1) << 17;      ///< pixels that are computed together
  std::shared_ptr<const AreaInScene> area = nullptr;  ///< if not null, only surface inside is on the map
};

/// Number of pixels per outcome. Pixels without a place on the earth count as `outside`.
struct MapTally {
  std::uint64_t with_surface = 0, without_surface = 0, missing = 0;
};

/// The pixels of a map, block by block.
/// Exact   The pixels do not depend on threads, batches, blocks or memory. A float is the query's double, rounded.
/// Cost    Holds a block and a batch of rays, and the trees of the query.
class SurfaceMap {
 public:
  /// Borrows all arguments.
  SurfaceMap(SceneQuery& query, const MapFrame& frame, const MapJob& job, const ThreadPool& pool);
  ~SurfaceMap();

  std::uint32_t block_columns() const;
  /// Returns the number of blocks. They are numbered row by row.
  std::uint64_t blocks() const;
  /// Computes a block: 4 bytes per pixel, row by row. Blocks on the eastern and southern border are smaller. The result
  /// is valid until the next call.
  /// Errors  The errors of SceneQuery::first_hits().
  std::span<const std::byte> block(std::uint64_t number, const Progress& progress = {});
  /// Returns the tally of all computed blocks.
  const MapTally& tally() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
