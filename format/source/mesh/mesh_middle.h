/// Where to put the origin of a mesh whose coordinates floats would round.
#pragma once

#include <array>
#include <span>

namespace gigabake {

/// The middle of all that are finite, in whole metres, where some are beyond 10 km; else zero. What is left after
/// subtracting it is rounded to floats: projected coordinates keep their millimetres.
std::array<double, 3> mesh_middle(std::span<const std::array<double, 3>> positions);

/// Between two neighbouring floats of the largest coordinate's size, in the file's own unit; 0 where there is none.
float float_step_of(std::span<const std::array<double, 3>> positions);

}  // namespace gigabake
