/// The sample's main river: its bends, its lake, its falling water level.
#pragma once

#include <cstdint>
#include <vector>

#include "sample/terrain/earth.h"

namespace gigabake::sample {

/// Position of a point relative to the river.
struct Reach {
  double shore_m = 0;  ///< distance to the nearest shore; negative in the water
  double level_m = 0;  ///< height of the water at the point's position along the valley
  double along_m = 0;  ///< position along the valley, increasing downstream
  bool west = false;   ///< whether the point is west of the river
};

class River {
 public:
  /// `relief_m` is the length of the landscape's large features.
  River(double size_m, double relief_m, std::uint32_t seed);
  Reach at(MapPoint p) const;
  /// Returns a point `along_m` downstream and `across_m` from the middle of the water (positive: east).
  MapPoint beside(double along_m, double across_m) const;
  double half_width_m(double along_m) const { return station(along_m).half_width_m; }

 private:
  struct Station {
    double across_m = 0, half_width_m = 0, level_m = 0;
  };
  Station station(double along_m) const;

  std::uint32_t seed_;
  double first_m_, step_m_, relief_m_;
  std::vector<Station> stations_;
};

}  // namespace gigabake::sample
