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
#include "kernels/marching/march.h"
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

/// Returns the next task of a ray that has composited a sample. `is_in_brick` is true if its current sample lies in the
/// current brick.
GB_HD CastTask next_in_brick(const CastRay& ray, bool is_in_brick) {
  if (ray.transmittance < transmittance_cutoff) return CastTask::none;
  return is_in_brick ? CastTask::step : CastTask::find;
}

/// The processing of samples with a residual.
enum class Residuals : std::uint8_t {
  composited,
  deferred  ///< such a sample stays the current sample, and the ray's next task becomes `residual`
};

/// Composites the residual at the current sample. If the ray hit a surface before this sample, composites nothing and
/// makes that surface the next task.
template <RayType ray_type, Residuals residuals = Residuals::composited>
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
  if (residuals == Residuals::deferred && has_residual(neighbourhood, ray.covered > 0)) {
    march.task = CastTask::residual;
    return;
  }
  ray.is_seen = false;
  keep_signed_distance(blend, line, brick.lod, distance, ray);
  ResidualSample residual;
  if constexpr (residuals == Residuals::composited)
    residual = volumetric_residual(corners, neighbourhood, line.direction, ray.covered > 0);
  double steps = 1;
  if (brick.lod != ray.lod)
    steps = steps_in_coarser(line.lod1_distance, brick.lod, ray.lod, ray.step, march.in_brick_until);
  const bool is_residual_only = residual.sample.mean_coverage() > 0;
  if constexpr (ray_type == RayType::lit) light_residual(scene, line, corners, ray, residual.sample);
  if (is_residual_only)
    composite<ray_type>(residual.sample, residual.translucent, line, brick, steps, distance, camera, ray);
  ray.step += steps;
  if (is_residual_only || blend.weight > 0) ray.past = ray.step;
  march.task = next_in_brick(ray, ray.step < march.in_brick_until);
}

/// Composites the surface that the ray hit at ray.met. The ray then continues at its current sample, behind the
/// surface.
template <RayType ray_type>
GB_HD void pass_surface(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool blocking,
                        MarchState& march, CastPath& path, CastRay& ray) {
  const bool is_there = meet_surface<ray_type>(scene, camera, line, blocking, ray.met, path, ray);
  ray.is_seen = is_there;
  march.task = is_there ? next_in_brick(ray, ray.step < march.in_brick_until) : CastTask::none;
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

#if defined(__CUDACC__)
/// The number of rays of a warp that have each of the tasks of marching.
struct TaskLanes {
  int find, step, pass;

  /// Returns the task that most rays have, or `none` if no ray marches.
  __device__ CastTask next() const {
    if (find + step + pass == 0) return CastTask::none;
    if (find >= step && find >= pass) return CastTask::find;
    return step >= pass ? CastTask::step : CastTask::pass;
  }
};

__device__ inline int lanes_with(CastTask task, CastTask which) {
  return __popc(__ballot_sync(0xffffffffu, task == which ? 1 : 0));
}

/// Counts the tasks of a warp's rays. All lanes of the warp must call this function.
__device__ inline TaskLanes task_lanes(CastTask task) {
  return {lanes_with(task, CastTask::find), lanes_with(task, CastTask::step), lanes_with(task, CastTask::pass)};
}
#endif

/// Returns the next task of a group of rays: the task that most of its rays have, or `none` if no ray marches.
GB_HD CastTask next_task(CastTask task) {
#if defined(__CUDA_ARCH__)
  return task_lanes(task).next();
#else
  return task;
#endif
}

/// The number of steps of a ray before a warp chooses its next task again.
inline constexpr int steps_together = 3;

GB_HD void step_often(const CastScene& scene, const CastLine& line, MarchState& march, CastRay& ray) {
  GB_NO_UNROLL
  for (int n = 0; n < steps_together && march.task == CastTask::step; ++n) step_in_brick(scene, line, march, ray);
}

/// Continues the ray until it hits a surface, is finished or waits. At any time, the rays of a warp do the same task.
/// On a device all lanes of a warp must call this function.
template <RayType ray_type = RayType::primary>
GB_HD void march_to_surface(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool blocking,
                            MarchState& march, CastPath& path, CastRay& ray) {
  while (true) {
    const CastTask next = next_task(march.task);
    if (next == CastTask::find) {
      if (march.task == CastTask::find) enter_brick(scene, line, blocking, march, path, ray);
    } else if (next == CastTask::step) {
      step_often(scene, line, march, ray);
    } else if (next == CastTask::pass) {
      if (march.task == CastTask::pass) pass_point<ray_type>(scene, camera, line, march, ray);
    } else {
      return;
    }
  }
}

/// Prepares a ray for the pass. `is_cast` is false if a lane of a device has no ray.
GB_HD void start_march(const CastScene& scene, const CastLine& line, bool is_cast, const CastRay& ray,
                       MarchState& march) {
  if (!is_cast || ray.lod < 0) return;
  march.task = CastTask::find;
  begin_level(scene, line, ray.lod, march);
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
