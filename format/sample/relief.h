/// The sample's ground: one height for every point of the map, whatever tile asks.
#pragma once

#include <cstdint>

#include "format/sample/raster.h"
#include "format/sample/river.h"

namespace gigabake::sample {

class Relief {
 public:
  /// Cost    half a second for the default size: shapes hills by erosion on a grid of at most 513² points.
  Relief(double size_m, std::uint32_t seed);

  /// Metres above the river at the map's origin; flat where there is water.
  double height_m(MapPoint p) const;
  /// Rise over run of the ground, smoothed over some metres.
  double slope(MapPoint p) const;
  /// 0 on dry crests … 1 where streams gather.
  double moisture(MapPoint p) const { return moisture_.linear(p); }
  /// Positive in hollows, negative on crests, about -1 … 1.
  double hollowness(MapPoint p) const { return hollowness_.linear(p); }
  const River& river() const { return river_; }
  /// The length of the landscape's big shapes.
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
