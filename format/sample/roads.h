/// Roads and tracks: they avoid slopes and water, join each other, and end at the map's rim.
#pragma once

#include <vector>

#include "format/sample/near_grid.h"
#include "format/sample/relief.h"

namespace gigabake::sample {

enum class RoadKind { main, street, track };

struct Road {
  RoadKind kind = RoadKind::main;
  double half_width_m = 3;
  std::vector<MapPoint> points;
};

/// The nearest road, if one is near.
struct RoadSight {
  double edge_m = 1e9;    ///< to the road's edge; negative on the road
  double middle_m = 1e9;  ///< to the road's middle
  double half_width_m = 0;
  RoadKind kind = RoadKind::track;
};

/// Finds ways over the ground at the least effort.
/// Cost    O(n log n) of a grid of at most 257² points a way.
class Surveyor {
 public:
  explicit Surveyor(const Relief& relief);
  /// From `from` to `to`, smoothed; every way makes the next one along it cheaper.
  std::vector<MapPoint> way(MapPoint from, MapPoint to);

 private:
  double effort(int from, int to, double distance_m) const;
  std::vector<int> shortest(int from, int to) const;
  int nearest(MapPoint p) const;

  Raster height_;
  std::vector<double> burden_;  ///< per point: what a metre costs besides its slope
};

class RoadNetwork {
 public:
  explicit RoadNetwork(double size_m) : near_(size_m, reach_m) {}
  void add(Road road);
  const std::vector<Road>& roads() const { return roads_; }
  /// The nearest road within `reach_m` of p.
  RoadSight nearest(MapPoint p) const;

  static constexpr double reach_m = 24;

 private:
  struct Segment {
    MapPoint a, b;
    int road;
  };

  std::vector<Road> roads_;
  std::vector<Segment> segments_;
  NearGrid near_;  ///< of segments
};

double distance_m(MapPoint a, MapPoint b);

}  // namespace gigabake::sample
