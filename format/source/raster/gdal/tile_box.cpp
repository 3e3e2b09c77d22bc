#include "format/source/raster/gdal/tile_box.h"

#include <algorithm>
#include <limits>

namespace gigabake {

void set_box(const Ground::Frame& frame, const std::vector<double>& x, const std::vector<double>& y, DemTile& tile) {
  constexpr double lowest_m = -12000, highest_m = 9000, margin = 0.02;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  tile.low_m = {infinity, infinity, infinity}, tile.high_m = {-infinity, -infinity, -infinity};
  for (std::size_t i = 0; i < x.size(); ++i)
    for (const double height_m : {lowest_m, highest_m}) {
      const Point<Scene> p = frame(x[i], y[i], height_m);
      const std::array<double, 3> at{p.x, p.y, p.z};
      for (std::size_t c = 0; c < 3; ++c)
        tile.low_m[c] = std::min(tile.low_m[c], at[c]), tile.high_m[c] = std::max(tile.high_m[c], at[c]);
    }
  for (std::size_t c = 0; c < 2; ++c) {
    const double spare_m = margin * (tile.high_m[c] - tile.low_m[c]);
    tile.low_m[c] -= spare_m, tile.high_m[c] += spare_m;
  }
}

}  // namespace gigabake
