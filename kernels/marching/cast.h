/// Ray casting through a paged scene, front to back.
///
/// A ray visits a fixed sequence of samples, and skips empty space. A level begins at the distance from which its
/// voxels are at most the pixel error wide. Its samples are half a voxel of the level apart. The samples and their
/// values depend only on the ray and the voxels. Once all requested data is resident, the image therefore does not
/// depend on cells, residency or the order of rays.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
/// Source  Crassin et al. 2009, "GigaVoxels" (rays that request missing data).
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/cast_camera.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/cast_ray.h"
#include "kernels/marching/level_sampler.h"
#include "kernels/marching/locate.h"
#include "kernels/marching/ray_light.h"
#include "kernels/marching/sample.h"
#include "kernels/marching/scene.h"
#include "kernels/marching/seen_side.h"
#include "kernels/marching/surface_blend.h"
#include "kernels/marching/surface_hit.h"

namespace gigabake::kernels {

GB_HD CastRay start_ray(const CastScene& scene, const CastLine& line) {
  CastRay ray;
  if (!(line.enter <= line.leave)) return ray;
  ray.lod = 0;
  while (ray.lod + 1 < scene.lods && line.enter >= lod_start(line, ray.lod + 1)) ++ray.lod;
  const double step = std::floor((line.enter - lod_start(line, ray.lod)) * steps_per_voxel(ray.lod) - 0.5);
  ray.step = step > 0 ? step : 0;
  return ray;
}

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
/// outside the brick, seen from `step`: the next sample must not depend on where the ray entered the brick, because a
/// ray continues in other passes, and on a device after each hit. The function is not inlined, because such bricks are
/// rare.
GB_HD_NOINLINE double steps_in_coarser(double lod1_distance, int brick_lod, int lod, double step, double beyond) {
  CastLine line;
  line.lod1_distance = lod1_distance;
  double steps = larger_of(std::floor(beyond) - step, 1);
  const double to_end = std::ceil((lod_end(line, lod) - point_distance(line, lod, step)) * steps_per_voxel(lod));
  if (to_end >= 1 && steps > to_end) steps = to_end;
  const double wide = power_of_two(brick_lod - lod);
  return steps < wide ? steps : wide;
}

/// Multiplies the colour of a sample by `light`, per channel.
GB_HD void multiply(const Vec3<float>& light, CastSample& sample) {
  GB_UNROLL
  for (int k = 0; k < 3; ++k) sample.c[k] *= light[k];
}

/// Lights the residual at the current sample on the side that the ray meets. The first sample in a surface determines
/// whether this is the side of the normals.
GB_HD void light_residual(const CastScene& scene, const CastLine& line, const CastCorners& corners, CastRay& ray,
                          CastSample& residual) {
  const Vec3d& d = line.direction;
  const bool is_there = residual.mean_coverage() > 0;
  if (ray.step != ray.past) ray.is_other_side = is_there && meets_other_side(corners, d[0], d[1], d[2]);
  if (is_there && ray.is_other_side) multiply(relative_light(corners, scene.light, d[0], d[1], d[2]), residual);
}

/// Composites the blended surface that the ray hit at distance `met`. Samples the surface's opacity at the hit, and its
/// colour at the hit and half a voxel before and behind the hit. A shadow ray needs no colour, so it samples only at
/// the hit. If `blocking` is true and data is missing, returns false: the ray must wait.
template <RayType ray_type>
GB_HD bool meet_surface(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool blocking,
                        double met, CastPath& path, CastRay& ray) {
  LevelSampler at(scene, line, ray.lod);
  CastSample sample;
  BrickTraits brick;
  double half = 0;
  float across = 1;
  bool is_other_side = false;
  SurfaceOpacity seen;
  GB_NO_UNROLL
  for (int side = 0; side < (ray_type == RayType::shadow ? 1 : 3); ++side) {
    at.look(scene, line, side == 0 ? met : (side == 1 ? met - half : met + half), blocking, path);
    if (at.place.waits && blocking) return false;
    if (!is_resident(at.place.brick)) {
      if (side == 0) return true;
      continue;
    }
    const BrickView here = scene.brick(at.place.brick);
    const CastPoint point = at.point();
    const CastCorners corners = corners_of(here, point);
    if (side == 0) {
      const BlendedPlanes planes = blend_planes(corners, ray.normal);
      const SurfaceBlend& blend = planes.blend;
      if (!(blend.weight > 0)) return true;
      seen = surface_opacity(here, point, blend);
      half = power_of_two(at.place.lod - 1);
      brick = at.traits();
      if (seen.density < 1 && is_between_surfaces(blend, line, ray)) return true;
      across = length_along(line.direction, blend.normal);
      is_other_side = planes.is_mixed || dot(blend.normal, to_seen_side(line, ray)) < 0;
    }
    const CastSample more = surface_sample(corners);
    GB_UNROLL
    for (int k = 0; k < cast_channels; ++k) sample.c[k] += more.c[k];
  }
  if constexpr (ray_type == RayType::lit)
    if (is_other_side)
      multiply(relative_surface_light(scene, line, ray.lod, met, half, to_seen_side(line, ray)), sample);
  if (seen.density < 1) stay_in_surface(met, across, float(2 * half), ray);
  const float covered = covered_in_surface(seen.opacity, seen.density, ray);
  composite_sample<ray_type>(sample, brick, stop_light(covered, brick.lod, seen.density, ray), met, 0, camera, ray);
  return true;
}

/// The next action of a ray.
enum class CastTask : std::uint8_t {
  seek,  ///< skip samples where the field is zero
  pass,  ///< process the current sample
  meet,  ///< composite the surface that was hit before the current sample
  none   ///< finished, or waiting for data
};

/// The state of a ray within a pass; only CastRay is kept between passes. CastPath is separate: a device indexes
/// CastPath by computed values, so it cannot keep CastPath in registers like this struct. Values that a step can
/// recompute are not stored, to save registers.
struct MarchState {
  CastTask task = CastTask::none;
  bool waits = false;         ///< SampleLocation::waits of the current brick
  LevelPoints points;         ///< the samples of the ray's level
  CellFrame frame;            ///< the cell that was found last
  std::int32_t lod = 0;       ///< level of the brick that holds the sample
  double in_brick_until = 0;  ///< samples before this step lie in that brick; later samples may not
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

/// Finishes the ray behind the scene, or switches it to the next level where that level begins. Returns true if either
/// happened.
GB_HD bool leaves_level(const CastScene& scene, const CastLine& line, MarchState& march, CastRay& ray) {
  const double distance = point_distance(line, ray.lod, ray.step);
  const bool in_surface = ray.step == ray.past;
  // Test the level first: a step over empty space may end behind the scene, while the next level still has a surface
  // before the scene's end.
  const double next_lod = in_surface ? lod_end(line, ray.lod) : lod_start(line, ray.lod + 1);
  if (ray.lod + 1 < scene.lods && distance >= next_lod && next_lod <= line.leave) {
    enter_next_lod(line, ray);
    march.points = level_points(scene, line, ray.lod);
    return true;
  }
  if (distance <= line.leave) return false;
  ray.lod = -1;
  march.task = CastTask::none;
  return true;
}

/// Finds the brick of the current sample. Returns false if the ray skips empty space, switches level, ends or waits. If
/// data is missing, the ray waits if `blocking` is true, and otherwise uses a coarser brick.
GB_HD bool enter_brick(const CastScene& scene, const CastLine& line, bool blocking, MarchState& march, CastPath& path,
                       CastRay& ray) {
  if (leaves_level(scene, line, march, ray)) return false;
  const FixedPoint at = march.points.at(line, ray.lod, ray.step);
  const SampleLocation place = find_brick(scene, line, ray.lod, at, blocking, march.frame, path);
  if (place.waits && blocking) {
    march.task = CastTask::none;
    return false;
  }
  const bool is_brick = is_resident(place.brick);
  const bool is_own_level = is_brick && place.lod == ray.lod;
  const double beyond =
      ray.step + steps_within(is_own_level ? exit_distance_node(line, place.at, place.lod) : place.exit_distance,
                              short_power_of_two(1 - ray.lod));
  if (!is_brick) {
    if (!leaves_surface(march, ray)) ray.step = beyond;
    return false;
  }
  march.in_brick_until = smaller_of(beyond, level_until(scene, line, ray.lod));
  march.lod = place.lod;
  march.waits = place.waits;
  march.head = load_head(scene.heads + place.brick);
  return true;
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

/// Skips empty space once, towards the next sample with a non-zero field or the next surface hit. The ray's task
/// becomes `none` if the ray leaves the scene or waits.
GB_HD void seek_surface(const CastScene& scene, const CastLine& line, bool blocking, MarchState& march, CastPath& path,
                        CastRay& ray) {
  if (!(ray.step < march.in_brick_until)) {
    march.in_brick_until = -1;
    if (!enter_brick(scene, line, blocking, march, path, ray)) return;
  }
  const FixedPoint at = point_of(line, march, ray);
  if (has_taps(scene, at, march)) {
    march.task = CastTask::pass;
    return;
  }
  if (leaves_surface(march, ray)) return;
  if (march.lod != ray.lod) {
    ray.step += steps_in_coarser(line.lod1_distance, march.lod, ray.lod, ray.step, march.in_brick_until);
    march.in_brick_until = -1;
    return;
  }
  const Vec3<std::uint32_t> u{at.in_node(0, march.lod), at.in_node(1, march.lod), at.in_node(2, march.lod)};
  ray.step += steps_within(exit_distance_empty_part(march.head.blocks, line, u), 2.0f / fixed_one);
}

/// Composites the residual at the current sample. If the ray hit a surface before this sample, composites nothing and
/// makes that surface the next task.
template <RayType ray_type>
GB_HD void pass_point(const CastScene& scene, const CastCamera& camera, const CastLine& line, MarchState& march,
                      CastRay& ray) {
  const BrickTraits brick{march.lod, march.frame.cell, march.waits};
  const double distance = point_distance(line, ray.lod, ray.step);
#if defined(__CUDA_ARCH__)
  const CastCorners corners =
      corners_of(scene.brick(march.head), point_in_brick(point_of(line, march, ray), march.lod));
#else
  const CastCorners& corners = march.corners;
#endif
  const NeighbourhoodSurface neighbourhood =
      classify_neighbourhood(corners, brick.lod, ray.lod, brick.waits, ray.normal);
  const SurfaceBlend& blend = neighbourhood.blend;
  if (is_met(surface_hit_distance(blend, line, brick.lod, distance, ray), march, ray)) return;
  ray.is_seen = false;
  keep_signed_distance(blend, line, brick.lod, distance, ray);
  ResidualSample residual = volumetric_residual(corners, neighbourhood, line.direction, ray.covered > 0);
  double steps = 1;
  if (brick.lod != ray.lod)
    steps = steps_in_coarser(line.lod1_distance, brick.lod, ray.lod, ray.step, march.in_brick_until);
  const bool is_residual_only = residual.sample.mean_coverage() > 0;
  if constexpr (ray_type == RayType::lit) light_residual(scene, line, corners, ray, residual.sample);
  if (is_residual_only)
    composite<ray_type>(residual.sample, residual.translucent, line, brick, steps, distance, camera, ray);
  ray.step += steps;
  if (is_residual_only || blend.weight > 0) ray.past = ray.step;
  if (brick.lod != ray.lod) march.in_brick_until = -1;
  march.task = ray.transmittance < transmittance_cutoff ? CastTask::none : CastTask::seek;
}

/// Composites the surface that the ray hit at ray.met. The ray then continues at its current sample, behind the
/// surface.
template <RayType ray_type>
GB_HD void pass_surface(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool blocking,
                        MarchState& march, CastPath& path, CastRay& ray) {
  const bool is_there = meet_surface<ray_type>(scene, camera, line, blocking, ray.met, path, ray);
  ray.is_seen = is_there;
  march.task = !is_there || ray.transmittance < transmittance_cutoff ? CastTask::none : CastTask::seek;
}

/// Tests whether any ray of a group has a task. On a host a group is one ray, on a device the rays of one warp. All
/// lanes of the warp must call this function.
GB_HD bool any_ray(bool has_task) {
#if defined(__CUDA_ARCH__)
  return __any_sync(0xffffffffu, has_task ? 1 : 0) != 0;
#else
  return has_task;
#endif
}

/// Returns true if the group of rays seeks next, and false if the group processes samples next. The group takes the
/// action that more of its rays need.
GB_HD bool seeks_next(CastTask task) {
#if defined(__CUDA_ARCH__)
  return __popc(__ballot_sync(0xffffffffu, task == CastTask::seek ? 1 : 0)) >=
         __popc(__ballot_sync(0xffffffffu, task == CastTask::pass ? 1 : 0));
#else
  return task == CastTask::seek;
#endif
}

/// The number of seek steps before the next action is chosen again.
inline constexpr int steps_together = 3;

/// Continues the ray until it hits a surface, is finished or waits. At any time, the rays of a warp either seek or
/// process samples (seeks_next()). On a device all lanes of a warp must call this function.
template <RayType ray_type = RayType::primary>
GB_HD void march_to_surface(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool blocking,
                            MarchState& march, CastPath& path, CastRay& ray) {
  while (any_ray(march.task == CastTask::seek || march.task == CastTask::pass)) {
    if (seeks_next(march.task)) {
      for (int step = 0; step < steps_together && march.task == CastTask::seek; ++step)
        seek_surface(scene, line, blocking, march, path, ray);
    } else if (march.task == CastTask::pass) {
      pass_point<ray_type>(scene, camera, line, march, ray);
    }
  }
}

/// Prepares a ray for the pass. `is_cast` is false if a lane of a device has no ray.
GB_HD void start_march(const CastScene& scene, const CastLine& line, bool is_cast, const CastRay& ray,
                       MarchState& march) {
  if (!is_cast || ray.lod < 0) return;
  march.task = CastTask::seek;
  march.points = level_points(scene, line, ray.lod);
}

/// Continues the ray until it is finished (lod = -1) or waits for data. In a warp, a surface is composited only when
/// all rays have hit a surface or have stopped, because compositing takes as long as about a dozen steps. On a device
/// all lanes of a warp must call this function.
template <RayType ray_type = RayType::primary>
GB_HD void cast_ray(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool blocking, bool is_cast,
                    CastRay& ray) {
  MarchState march;
  CastPath path;
  start_march(scene, line, is_cast, ray, march);
  while (any_ray(march.task != CastTask::none)) {
    march_to_surface<ray_type>(scene, camera, line, blocking, march, path, ray);
    if (march.task == CastTask::meet) pass_surface<ray_type>(scene, camera, line, blocking, march, path, ray);
  }
  finish_opaque(ray);
}

}  // namespace gigabake::kernels
