/// Positions of roads, houses and trees on the sample's map.
#pragma once

#include <cstdint>
#include <vector>

#include "sample/settlement/roads.h"
#include "sample/terrain/relief.h"

namespace gigabake::sample {

struct House {
  MapPoint centre;
  double heading_deg = 0;  ///< direction of the ridge, counter-clockwise from east
  double length_m = 10, depth_m = 8, wall_m = 3, roof_m = 3;
  int wall_tint = 0, roof_tint = 0;
};

enum class TreeKind { broadleaf, conifer };

struct Tree {
  MapPoint foot;
  TreeKind kind = TreeKind::broadleaf;
  double height_m = 8, crown_m = 5;  ///< crown_m: diameter of the crown
  std::uint32_t seed = 0;
};

/// All roads, houses and trees. They depend only on size and seed, so all tiles are consistent.
class Settlement {
 public:
  Settlement(const Relief& relief, std::uint32_t seed);

  const RoadNetwork& roads() const { return roads_; }
  const std::vector<House>& houses() const { return houses_; }
  /// Returns the trees whose foot lies in [min, max). Computes them per grid cell, so a map of any size needs no list.
  std::vector<Tree> trees_in(MapPoint min, MapPoint max) const;
  /// Returns the distance to the nearest house's centre, at most 24 m.
  double to_house_m(MapPoint p) const;

 private:
  void lay_roads();
  void build_along(const Road& road, MapPoint centre, double radius_m);
  bool can_build(const House& house) const;
  bool tree_at(std::int32_t x, std::int32_t y, Tree& tree) const;

  const Relief& relief_;
  std::uint32_t seed_;
  RoadNetwork roads_;
  std::vector<MapPoint> villages_;
  std::vector<House> houses_;
  NearGrid near_houses_;
};

}  // namespace gigabake::sample
