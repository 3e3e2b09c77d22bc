/// Points of a scene in fixed point: bit shifts yield the brick that contains a point and the position in that brick.
///
/// Space   1/65536 of a lod-0 voxel, relative to a corner: CastScene::corner or the corner of a cell.
/// Exact   Integers, each from one rounding of an IEEE double: host and device return the same bits. Coordinates of the
///         same point relative to two corners differ by exactly the distance of the corners.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/brick.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/scene.h"

namespace gigabake::kernels {

inline constexpr int fraction_bits = 16;
inline constexpr std::uint32_t fixed_one = 1u << fraction_bits;
inline constexpr int brick_bits = 3;
static_assert(1 << brick_bits == brick_edge);

/// The bias that converts a double to fixed point. The sum of the bias and a value of magnitude below 2^35 is rounded
/// to a multiple of 1/65536. The bits of the sum minus fixed_bias_bits are then the fixed-point number.
inline constexpr double fixed_bias = 1.5 * double(std::int64_t(1) << (52 - fraction_bits));
inline constexpr std::uint64_t fixed_bias_bits = std::bit_cast<std::uint64_t>(fixed_bias);

/// The upper bound for the edge of a scene in voxels. Rays sample less than this distance beyond the scene.
inline constexpr std::int64_t max_scene_edge = std::int64_t(1) << 33;

inline constexpr std::uint32_t node_mask = (fixed_one << brick_bits) - 1;

/// A point whose coordinates include the bits of fixed_bias. The members shift and truncate these bits away.
struct FixedPoint {
  Vec3<std::uint64_t> bits;

  GB_HD std::uint32_t voxel(int a) const { return std::uint32_t(bits[a] >> fraction_bits); }
  /// Returns the position in the point's node of level `lod`, in 1/65536 of that level's voxels. A node is 8 voxels
  /// wide.
  GB_HD std::uint32_t in_node(int a, int lod) const { return std::uint32_t(bits[a] >> lod) & node_mask; }
};

/// Returns 2^exponent, like power_of_two().
/// Range   -126 … 127.
GB_HD float short_power_of_two(int exponent) { return std::bit_cast<float>(std::uint32_t(127 + exponent) << 23); }

/// Returns the distance between two samples of a ray on a level: half a voxel of that level.
GB_HD double step_length(int lod) { return power_of_two(lod - 1); }
/// Returns the number of steps per lod-0 voxel.
GB_HD double steps_per_voxel(int lod) { return power_of_two(1 - lod); }
/// Returns the distance at which a level begins.
GB_HD double lod_start(const CastLine& line, int lod) {
  return lod == 0 ? 0 : line.lod1_distance * power_of_two(lod - 1);
}
/// Returns the distance of sample `step` of a level.
GB_HD double point_distance(const CastLine& line, int lod, double step) {
  return lod_start(line, lod) + (step + 0.5) * step_length(lod);
}

/// The samples of one level of a ray. Their coordinates are relative to the level's lowest voxel centre. The integer
/// parts therefore select the lowest of the eight voxels around a sample.
struct LevelPoints {
  Vec3d first;  ///< sample 0, including the bias

  /// Returns the sample `index`; a fractional index yields a point between two samples.
  GB_HD FixedPoint at(const CastLine& line, int lod, double index) const {
    const double along = index * step_length(lod);
    FixedPoint point;
    for (int a = 0; a < 3; ++a) point.bits[a] = std::bit_cast<std::uint64_t>(first[a] + line.direction[a] * along);
    return point;
  }
};

/// Returns a level's samples relative to the scene's corner.
GB_HD LevelPoints level_points(const CastScene& scene, const CastLine& line, int lod) {
  const double half = power_of_two(lod - 1), distance = point_distance(line, lod, 0);
  LevelPoints points;
  for (int a = 0; a < 3; ++a)
    points.first[a] = (((line.origin[a] - double(scene.corner[a])) - half) + line.direction[a] * distance) + fixed_bias;
  return points;
}

/// An upper bound of the rounding error of a length, in 1/65536: two points are rounded, and one result is truncated.
inline constexpr float fixed_spare = 4;

/// Returns the distance along the ray to the side of a box that the ray crosses on an axis. Rounding may shorten the
/// distance, but never lengthens it. `at` is the point's coordinate relative to the lower side of the box. `edge` is
/// the box's edge, a power of two. `at`, `edge` and the result have the same unit: 1/65536 of a voxel of any level.
GB_HD float distance_to_side(const CastLine& line, int axis, std::uint32_t at, std::uint32_t edge) {
  const std::uint32_t behind = (at ^ backward(line, axis)) & (edge - 1);
  return (float(edge - behind) - fixed_spare) * line.inv_direction[axis];
}

GB_HD float min_of(const Vec3<float>& v) {
  const float two = v[0] < v[1] ? v[0] : v[1];
  return two < v[2] ? two : v[2];
}

/// Returns the number of steps, an integer n ≥ 1, by which a ray may advance within the distance `along`. All samples
/// fewer than n steps ahead are guaranteed to be nearer than `along`.
GB_HD double steps_within(float along, float steps_per_unit) {
  const float steps = std::ceil(along * (steps_per_unit * (1 - 1e-6f)));
  return steps > 1 ? double(steps) : 1;
}

}  // namespace gigabake::kernels
