/// Points of a scene as whole numbers: which brick one lies in, and where in it, are shifts of these.
///
/// Space   Lod-0 voxels from a corner on, 65536ths of one. The corner is the scene's (CastScene::corner) or a cell's.
/// Exact   Integers, made by one rounding of an IEEE double: host and device return the same bits, and the same point
///         from another corner differs by exactly what lies between the two.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "kernels/cast/cast_line.h"
#include "kernels/cast/scene.h"
#include "lattice/brick.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

inline constexpr int fraction_bits = 16;
inline constexpr std::uint32_t fixed_one = 1u << fraction_bits;
inline constexpr int brick_bits = 3;
static_assert(1 << brick_bits == brick_edge);

/// A sum with it has a 65536th as its last place, as long as what was added is less than 2^35 either way: then its bits
/// count 65536ths, beside those of the bias.
inline constexpr double fixed_bias = 1.5 * double(std::int64_t(1) << (52 - fraction_bits));
inline constexpr std::uint64_t fixed_bias_bits = std::bit_cast<std::uint64_t>(fixed_bias);

/// No scene is wider, and rays look at less than that beyond it.
inline constexpr std::int64_t widest_scene = std::int64_t(1) << 33;

inline constexpr std::uint32_t node_mask = (fixed_one << brick_bits) - 1;

/// Each coordinate with the bits of the bias, which no shift below brings down.
struct FixedPoint {
  std::uint64_t bits[3];

  GB_HD std::uint32_t voxel(int a) const { return std::uint32_t(bits[a] >> fraction_bits); }
  /// Where it lies in its node of a level, in 65536ths of that level's voxels; a node is 8 of them wide.
  GB_HD std::uint32_t in_node(int a, int lod) const { return std::uint32_t(bits[a] >> lod) & node_mask; }
};

/// Exact, as power_of_two(). Range  -126 … 127.
GB_HD float short_power_of_two(int exponent) { return std::bit_cast<float>(std::uint32_t(127 + exponent) << 23); }

/// Distances between the points that a ray looks at on a level: half a voxel. And how far away its first one is.
GB_HD double step_length(int lod) { return power_of_two(lod - 1); }
GB_HD double steps_per_voxel(int lod) { return power_of_two(1 - lod); }
GB_HD double lod_start(const CastLine& line, int lod) {
  return lod == 0 ? 0 : line.lod1_distance * power_of_two(lod - 1);
}
GB_HD double point_distance(const CastLine& line, int lod, double step) {
  return lod_start(line, lod) + (step + 0.5) * step_length(lod);
}

/// The points of one level of a ray, each as it lies to the lowest of the eight centres around it.
struct LevelPoints {
  double first[3];  ///< point 0, with the bias

  /// Range  index: between points too.
  GB_HD FixedPoint at(const CastLine& line, int lod, double index) const {
    const double way = index * step_length(lod);
    FixedPoint point;
    for (int a = 0; a < 3; ++a) point.bits[a] = std::bit_cast<std::uint64_t>(first[a] + line.direction[a] * way);
    return point;
  }
};

/// Counted from the scene's corner.
GB_HD LevelPoints level_points(const CastScene& scene, const CastLine& line, int lod) {
  const double half = power_of_two(lod - 1), distance = point_distance(line, lod, 0);
  LevelPoints points;
  for (int a = 0; a < 3; ++a)
    points.first[a] = (((line.origin[a] - double(scene.corner[a])) - half) + line.direction[a] * distance) + fixed_bias;
  return points;
}

/// What of lengths in 65536ths rounding may have made up: both of two points are rounded, and one is cut off.
inline constexpr float fixed_spare = 4;

/// How far ahead along the ray the side of a box is that it meets on an axis; in 65536ths of whatever voxel `at` is
/// counted in, the place of a point above the box's lower side. edge: of the box, a power of two.
GB_HD float way_to_side(const CastLine& line, int axis, std::uint32_t at, std::uint32_t edge) {
  const std::uint32_t behind = (at ^ backward(line, axis)) & (edge - 1);
  return (float(edge - behind) - fixed_spare) * line.way_per_voxel[axis];
}

GB_HD float smallest_of(const float v[3]) {
  const float two = v[0] < v[1] ? v[0] : v[1];
  return two < v[2] ? two : v[2];
}

/// A whole number, 1 or more: all points that are fewer steps ahead are nearer than `way`, for certain.
GB_HD double steps_within(float way, float steps_per_unit) {
  const float steps = std::ceil(way * (steps_per_unit * (1 - 1e-6f)));
  return steps > 1 ? double(steps) : 1;
}

}  // namespace gigabake::kernels
