/// Running water and gravity shape a height field.
#pragma once

#include <cstdint>
#include <vector>

#include "format/sample/raster.h"

namespace gigabake::sample {

struct ErosionOptions {
  int steps = 36;
  double stream_power = 0.16;  ///< lowering per step, per metre of √(drained area) and unit slope
  double gully_m2 = 0;         ///< less drained area than this cuts nothing: hillslopes stay smooth
  double talus = 0.6;          ///< slope that loose ground holds
  double creep = 0.3;          ///< share of the way to the neighbours' mean that soil creeps in a step
};

/// Lifts `height` by `uplift_m` spread over the steps while streams cut into it and slopes slump. Points with a
/// non-zero `base` are where water leaves: they keep their height. Returns the area in m² that drains through each
/// point. Cost    O(n log n) a step. Source  Braun & Willett 2013 (implicit stream power, n = 1, m = 1/2); Barnes,
/// Lehman & Mulla 2014 (priority flood).
Raster erode(Raster& height, const Raster& uplift_m, const std::vector<std::uint8_t>& base,
             const ErosionOptions& options);

}  // namespace gigabake::sample
