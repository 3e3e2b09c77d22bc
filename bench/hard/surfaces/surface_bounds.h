/// Goals and bounds of the cases of surfaces. The goals of docs/accuracy-suite.md are not all met. A value beyond its
/// goal has the bound that was reached, which may only move towards the goal.
#pragma once

#include <string>

#include "bench/hard/hard_bench.h"

namespace gigabake::bench {

inline constexpr HardRange area_of_town{0.97, 1.05};  ///< covered area divided by the true area
inline constexpr HardRange area_of_thin_objects{1 / 1.5, 1.5};
inline constexpr HardRange no_wrong_normals{0, 0};  ///< fraction of pixels
inline constexpr HardRange same_light_codes{0, 3};
inline constexpr HardRange no_stripes{0, 0.01};    ///< fraction of pixels
inline constexpr HardRange dark_inside{0, 0.005};  ///< fraction of pixels

/// Returns a figure of a case with its goal. Its bound is the goal, or the bound that was reached if that is farther.
HardFigure bounded(const std::string& scene, const std::string& name, const std::string& unit, double measured,
                   const HardRange& goal);

}  // namespace gigabake::bench
