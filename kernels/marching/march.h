/// Steps of a ray through a paged scene: finding bricks, and skipping empty space within and between bricks.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/cast_ray.h"
#include "kernels/marching/fixed_point.h"
#include "kernels/marching/locate.h"
#include "kernels/marching/sample.h"
#include "kernels/marching/scene.h"
#include "kernels/marching/surface_hit.h"

namespace gigabake::kernels {

/// Returns the distance along the ray from point `u` to the exit of the empty, aligned cube around it. The cube has an
/// edge of half or else a quarter of the brick. Returns 0 if neither cube is empty. `u` is relative to the brick; `u`
/// and the result are in 1/65536 of the brick's voxels. `blocks` is CastHead::blocks.
GB_HD float exit_distance_empty_part(std::uint64_t blocks, const CastLine& line, const Vec3<std::uint32_t>& u) {
  const int x = int(u[0] >> fraction_bits), y = int(u[1] >> fraction_bits), z = int(u[2] >> fraction_bits);
  constexpr std::uint64_t eight_blocks = 0x330033;
  const bool is_half = (blocks >> block_of(x & 4, y & 4, z & 4) & eight_blocks) == 0;
  if (!is_half && (blocks >> block_of(x, y, z) & 1) != 0) return 0;
  const std::uint32_t edge = fixed_one << (is_half ? 2 : 1);
  Vec3<float> distances;
  GB_UNROLL
  for (int a = 0; a < 3; ++a) distances[a] = distance_to_side(line, a, u[a], edge);
  return min_of(distances);
}

/// Returns the latest distance at which to switch to the next level. Inside a surface the switch is deferred, because
/// coverages of two levels cannot be added.
GB_HD double lod_end(const CastLine& line, int lod) { return lod_start(line, lod + 1) + 8 * step_length(lod + 1); }

/// Switches the ray to the next level. The level's first sample lies behind the ray's latest surface, or at the level's
/// regular start if that is farther. This sample does not depend on the empty space that was skipped.
GB_HD void enter_next_lod(const CastLine& line, CastRay& ray) {
  const double from = point_distance(line, ray.lod, ray.past) - lod_start(line, ray.lod + 1);
  ++ray.lod;
  const double step = std::ceil(from * steps_per_voxel(ray.lod) - 0.5);
  ray.step = step > 0 ? step : 0;
  ray.past = -1;
}

/// Returns the number of the ray's steps to its next sample in a coarser brick. The next sample is half a voxel of the
/// brick ahead, unless the brick or the ray's level ends before. `beyond` is the step of the first sample that may lie
/// outside the brick. It must not depend on where the ray entered the brick, because a ray continues in other passes,
/// and on a device after each hit. The function is not inlined, because such bricks are rare.
GB_HD_NOINLINE double steps_in_coarser(double lod1_distance, int brick_lod, int lod, double step, double beyond) {
  CastLine line;
  line.lod1_distance = lod1_distance;
  double steps = larger_of(std::floor(beyond) - step, 1);
  const double to_end = std::ceil((lod_end(line, lod) - point_distance(line, lod, step)) * steps_per_voxel(lod));
  if (to_end >= 1 && steps > to_end) steps = to_end;
  const double wide = power_of_two(brick_lod - lod);
  return steps < wide ? steps : wide;
}

/// The next action of a ray.
enum class CastTask : std::uint8_t {
  find,      ///< find the brick of the current sample, or skip empty nodes
  step,      ///< skip samples within the brick where the field is zero
  pass,      ///< process the current sample
  residual,  ///< the same, for a sample with a residual; only between kernels of a device
  meet,      ///< composite the surface that was hit before the current sample
  none       ///< finished, or waiting for data
};

/// The state of a ray within a pass; only CastRay is kept between passes. CastPath is separate: a device indexes
/// CastPath by computed values, so it cannot keep CastPath in registers like this struct. Values that a step can
/// recompute are not stored, to save registers.
struct MarchState {
  CastTask task = CastTask::none;
  bool waits = false;         ///< SampleLocation::waits of the current brick
  LevelPoints points;         ///< the samples of the ray's level
  double in_level_until = 0;  ///< level_until() of the ray's level
  CellFrame frame;            ///< the cell that was found last
  std::int32_t lod = 0;       ///< level of the brick that holds the sample
  double in_brick_until = 0;  ///< samples before this step lie in that brick; later samples may not
  std::uint32_t brick = 0;    ///< slot of that brick
  CastHead head;              ///< the header of that brick
  CastCorners corners;        ///< the taps of the sample to process; unused on devices, to save registers
};

/// Returns the ray's current sample in the coordinates of SampleLocation::at, for the level of the sample's brick.
GB_HD FixedPoint point_of(const CastLine& line, const MarchState& march, const CastRay& ray) {
  FixedPoint point = march.points.at(line, ray.lod, ray.step);
  point.bits[2] -= march.frame.low;
  if (march.lod != ray.lod) count_for_level(ray.lod, march.lod, point);
  return point;
}

/// Returns true if `met` is a hit that has not been composited yet; the ray's next task is then to composite it.
GB_HD bool is_met(double met, MarchState& march, CastRay& ray) {
  if (ray.is_seen || met == met_nowhere) return false;
  ray.met = met;
  march.task = CastTask::meet;
  return true;
}

/// Handles a sample with a zero field. Returns true if the ray hit a surface before this sample; the ray's next task is
/// then to composite that surface.
GB_HD bool leaves_surface(MarchState& march, CastRay& ray) {
  if (is_met(extrapolated_hit(ray), march, ray)) return true;
  ray.is_seen = false;
  ray.signed_distance = CastRay::no_signed_distance;
  ray.normal = 0;
  return false;
}

/// Returns a lower bound of the step at which the ray leaves the level or the scene; it is at most one step too low.
GB_HD double level_until(const CastScene& scene, const CastLine& line, int lod) {
  const double start = lod_start(line, lod);
  const double end = lod + 1 < scene.lods ? smaller_of(lod_start(line, lod + 1), line.leave) : line.leave;
  return (end - start) * steps_per_voxel(lod) - 1.5;
}

/// Sets the members that depend only on the ray's level.
GB_HD void begin_level(const CastScene& scene, const CastLine& line, int lod, MarchState& march) {
  march.points = level_points(scene, line, lod);
  march.in_level_until = level_until(scene, line, lod);
}

/// Finishes the ray behind the scene, or switches it to the next level where that level begins. Returns true if either
/// happened.
GB_HD bool leaves_level(const CastScene& scene, const CastLine& line, MarchState& march, CastRay& ray) {
  if (ray.step < march.in_level_until) return false;
  const double distance = point_distance(line, ray.lod, ray.step);
  const bool in_surface = ray.step == ray.past;
  // Test the level first: a step over empty space may end behind the scene, while the next level still has a surface
  // before the scene's end.
  const double next_lod = in_surface ? lod_end(line, ray.lod) : lod_start(line, ray.lod + 1);
  if (ray.lod + 1 < scene.lods && distance >= next_lod && next_lod <= line.leave) {
    enter_next_lod(line, ray);
    begin_level(scene, line, ray.lod, march);
    return true;
  }
  if (distance <= line.leave) return false;
  ray.lod = -1;
  march.task = CastTask::none;
  return true;
}

/// Finds the brick of the current sample. The ray then steps in that brick, unless it skips empty space, switches
/// level, hits a surface, ends or waits. If data is missing, the ray waits if `blocking` is true, and otherwise uses a
/// coarser brick.
GB_HD void enter_brick(const CastScene& scene, const CastLine& line, bool blocking, MarchState& march, CastPath& path,
                       CastRay& ray) {
  march.in_brick_until = -1;
  if (leaves_level(scene, line, march, ray)) return;
  const FixedPoint at = march.points.at(line, ray.lod, ray.step);
  const SampleLocation place = find_brick(scene, line, march.points, ray.lod, at, blocking, march.frame, path);
  if (place.waits && blocking) {
    march.task = CastTask::none;
    return;
  }
  const bool is_brick = is_resident(place.brick);
  const double beyond =
      is_brick && place.lod != ray.lod
          ? place.exit_step
          : ray.step + steps_within(is_brick ? exit_distance_node(line, place.at, place.lod) : place.exit_distance,
                                    short_power_of_two(1 - ray.lod));
  if (!is_brick) {
    if (!leaves_surface(march, ray)) ray.step = beyond;
    return;
  }
  march.in_brick_until = smaller_of(beyond, march.in_level_until);
  march.lod = place.lod;
  march.waits = place.waits;
  march.brick = place.brick;
  march.head = load_head(scene.heads + place.brick);
  march.task = CastTask::step;
}

/// Tests whether the field at the point is not zero. On hosts keeps the taps for pass_point().
GB_HD bool has_taps(const CastScene& scene, const FixedPoint& at, MarchState& march) {
  const CastPoint point = point_in_brick(at, march.lod);
#if defined(__CUDA_ARCH__)
  return !is_zero(march.head.blocks, scene.brick(march.head), point);
#else
  if (is_empty_block(march.head.blocks, point.base.v)) return false;
  march.corners = corners_of(scene.brick(march.head), point);
  return march.corners.there() != 0;
#endif
}

/// Tests the current sample, which lies in the current brick. If the field is zero there, skips empty space within the
/// brick. The ray's next task is then the sample, a surface hit before it, or to find another brick.
GB_HD void step_in_brick(const CastScene& scene, const CastLine& line, MarchState& march, CastRay& ray) {
  const FixedPoint at = point_of(line, march, ray);
  if (has_taps(scene, at, march)) {
    march.task = CastTask::pass;
    return;
  }
  if (leaves_surface(march, ray)) return;
  if (march.lod != ray.lod) {
    ray.step += steps_in_coarser(line.lod1_distance, march.lod, ray.lod, ray.step, march.in_brick_until);
  } else {
    const Vec3<std::uint32_t> u{at.in_node(0, march.lod), at.in_node(1, march.lod), at.in_node(2, march.lod)};
    ray.step += steps_within(exit_distance_empty_part(march.head.blocks, line, u), 2.0f / fixed_one);
  }
  if (!(ray.step < march.in_brick_until)) march.task = CastTask::find;
}

}  // namespace gigabake::kernels
