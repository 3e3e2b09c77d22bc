/// Roads and tracks: they avoid slopes and water, join each other, and end at the map's border.
#pragma once

#include <vector>

#include "sample/terrain/near_grid.h"
#include "sample/terrain/relief.h"

namespace gigabake::sample {

enum class RoadKind { main, street, track };

struct Road {
  RoadKind kind = RoadKind::main;
  double half_width_m = 3;
  std::vector<MapPoint> points;
};

/// The nearest road within RoadNetwork::reach_m. The default values mean that no road is near.
struct RoadSight {
  double edge_m = 1e9;    ///< distance to the road's edge; negative on the road
  double middle_m = 1e9;  ///< distance to the road's middle
  double half_width_m = 0;
  RoadKind kind = RoadKind::track;
};

/// A search for paths of minimal cost over the ground.
/// Cost    O(n log n) per path, on a grid of at most 257² points.
class ScanThread {
 public:
  explicit ScanThread(const Relief& relief);
  /// Returns a smoothed path from `from` to `to`. Each path makes later paths along it cheaper.
  std::vector<MapPoint> way(MapPoint from, MapPoint to);

 private:
  double effort(int from, int to, double distance_m) const;
  std::vector<int> minimum(int from, int to) const;
  int nearest(MapPoint p) const;

  Raster height_;
  std::vector<double> burden_;  ///< per point: factor of the cost per metre
};

class RoadNetwork {
 public:
  explicit RoadNetwork(double size_m) : near_(size_m, reach_m) {}
  void add(Road road);
  const std::vector<Road>& roads() const { return roads_; }
  /// Returns the nearest road within `reach_m` of p.
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
