/// Erosion of a height field by water and gravity.
#pragma once

#include <cstdint>
#include <vector>

#include "sample/terrain/raster.h"

namespace gigabake::sample {

struct ErosionOptions {
  int steps = 36;
  double stream_power = 0.16;  ///< lowering per step, per metre of √(drained area) and unit slope
  double gully_m2 = 0;         ///< min drained area that erodes; smaller areas leave hillslopes smooth
  double talus = 0.6;          ///< max stable slope of unconsolidated ground
  double creep = 0.3;          ///< fraction of the distance to the neighbours' mean that soil moves per step
};

/// Raises `height` by `uplift_m`, divided evenly over the steps, while streams cut into it and slopes slump. Points
/// with a non-zero `base` are outlets of the water and keep their height. Returns the area in m² that drains through
/// each point.
/// Cost    O(n log n) per step.
/// Source  Braun & Willett 2013 (implicit stream power, n = 1, m = 1/2); Barnes, Lehman & Mulla 2014 (priority flood).
Raster erode(Raster& height, const Raster& uplift_m, const std::vector<std::uint8_t>& base,
             const ErosionOptions& options);

}  // namespace gigabake::sample
