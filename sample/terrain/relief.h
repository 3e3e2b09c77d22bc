/// The sample's ground: the height at every point of the map, independent of tiles.
#pragma once

#include <cstdint>

#include "sample/terrain/raster.h"
#include "sample/terrain/river.h"

namespace gigabake::sample {

class Relief {
 public:
  /// Cost    Half a second for the default size: erodes hills on a grid of at most 513² points.
  Relief(double size_m, std::uint32_t seed);

  /// Returns the height in metres above the river at the map's origin. On water, returns the water's level.
  double height_m(MapPoint p) const;
  /// Returns the slope of the ground (rise over run), smoothed over some metres.
  double slope(MapPoint p) const;
  /// Returns the moisture of the ground: 0 on dry crests, up to 1 where streams converge.
  double moisture(MapPoint p) const { return moisture_.linear(p); }
  /// Returns how hollow the ground is: positive in hollows, negative on crests, about -1 … 1.
  double hollowness(MapPoint p) const { return hollowness_.linear(p); }
  const River& river() const { return river_; }
  /// Returns the length of the landscape's large features in metres.
  double relief_m() const { return relief_m_; }
  double size_m() const { return size_m_; }

 private:
  double shaped_height_m(MapPoint p) const;
  void shape();
  void measure(const Raster& drained_area);

  double size_m_, relief_m_;
  std::uint32_t seed_;
  River river_;
  Raster ground_, slope_, moisture_, hollowness_;
};

}  // namespace gigabake::sample
