/// Exits of rays from nodes.
///
/// Space   Distances are lod-0 voxels.
/// Exact   IEEE float and double: host and device return the same bits.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/fixed_point.h"

namespace gigabake::kernels {

GB_HD float smaller_of(float a, float b) { return a < b ? a : b; }

/// A step behind the end of every ray.
inline constexpr double no_exit = 1e300;

/// Returns the distance along the ray from a point to the exit of its node of level `lod`, in lod-0 voxels.
GB_HD float exit_distance_node(const CastLine& line, const FixedPoint& point, int lod) {
  Vec3<float> exit_distance;
  GB_UNROLL
  for (int a = 0; a < 3; ++a) exit_distance[a] = distance_to_side(line, a, point.in_node(a, lod), node_mask + 1);
  return min_of(exit_distance) * short_power_of_two(lod - fraction_bits);
}

/// Returns the step of the first sample of level `lod` that may lie outside the node of level `node_lod` around a
/// sample. The result is the same for all samples in the node. `at` is the sample in coordinates of the node's tree.
GB_HD double exit_step_node(const CastLine& line, const LevelPoints& points, int lod, const FixedPoint& point,
                            const FixedPoint& at, int node_lod) {
  constexpr double spare = 2;  // the coordinates of samples are rounded
  const std::uint64_t edge = std::uint64_t(fixed_one) << (brick_bits + node_lod);
  double exit_step = no_exit;
  for (int a = 0; a < 3; ++a) {
    const bool is_backward = backward(line, a) != 0;
    const std::uint64_t in_node = at.bits[a] & (edge - 1), first = std::bit_cast<std::uint64_t>(points.first[a]);
    const std::uint64_t to_first = is_backward ? first - point.bits[a] : point.bits[a] - first,
                        to_side = is_backward ? in_node + 1 : edge - in_node;
    const double speed = (is_backward ? -line.direction[a] : line.direction[a]) * (step_length(lod) * fixed_one);
    if (speed > 0)
      exit_step = smaller_of(exit_step, std::ceil((double(std::int64_t(to_first + to_side)) - spare) / speed));
  }
  return exit_step;
}

}  // namespace gigabake::kernels
