/// Lookup of the items near a point of the map.
#pragma once

#include <span>
#include <vector>

#include "sample/terrain/earth.h"

namespace gigabake::sample {

/// A grid of square buckets over the map. Each bucket lists the items within `reach_m` of the bucket.
class NearGrid {
 public:
  NearGrid(double size_m, double reach_m);
  /// Adds an item that covers the box from `min` to `max`.
  void add(MapPoint min, MapPoint max, int item);
  /// Returns every item within `reach_m` of p, and some farther items, in the order of addition.
  /// Cost    O(1).
  std::span<const int> near(MapPoint p) const;

 private:
  int bucket(double coordinate_m) const;

  double reach_m_, low_m_, bucket_m_;
  int buckets_;
  std::vector<std::vector<int>> items_;
};

}  // namespace gigabake::sample
