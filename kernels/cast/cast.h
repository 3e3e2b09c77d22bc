/// Casting rays through a paged scene, front to back.
///
/// A ray walks a fixed sequence of points: on level l they lie half a voxel of l apart, and l is the level whose voxels
/// are at most a pixel wide at that distance. Which points are looked at, and what is seen there, depends on the ray
/// and the voxels alone; empty space is only stepped over. So neither the cells, nor what was here when, nor the order
/// of rays shows in the picture, once everything that the rays want has come.
///
/// Space   Lod-0 voxels of the scene's lattice; distances in them too.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
/// Source  Crassin et al. 2009, "GigaVoxels" (rays that ask for what they miss).
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/cast/cast_camera.h"
#include "kernels/cast/cast_line.h"
#include "kernels/cast/locate.h"
#include "kernels/cast/ray_light.h"
#include "kernels/cast/sample.h"
#include "kernels/cast/scene.h"
#include "kernels/cast/sheet.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

GB_HD double lod_start(const CastLine& line, int lod) {
  return lod == 0 ? 0 : line.lod1_distance * power_of_two(lod - 1);
}

GB_HD CastRay start_ray(const CastScene& scene, const CastLine& line) {
  CastRay ray;
  if (!(line.enter <= line.leave)) return ray;
  ray.lod = 0;
  while (ray.lod + 1 < scene.lods && line.enter >= lod_start(line, ray.lod + 1)) ++ray.lod;
  const double step = std::floor((line.enter - lod_start(line, ray.lod)) * steps_per_voxel(ray.lod) - 0.5);
  ray.step = step > 0 ? step : 0;
  return ray;
}

/// Where the field is zero.
struct EmptyBox {
  double min[3], max[3];
};

GB_HD EmptyBox empty_box(const CastPlace& place) {
  EmptyBox box;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = place.min[a] + place.half;
    box.max[a] = place.max[a] + place.half + place.beyond;
  }
  return box;
}

/// Half of a brick along each axis, or a quarter, around a point where the field is zero: false where it is not zero in
/// all of either. blocks: the brick's.
GB_HD bool find_empty_part(std::uint64_t blocks, const CastPlace& place, const CastPoint& point, EmptyBox& box) {
  const std::uint64_t half = blocks >> block_of(point.base[0] & 4, point.base[1] & 4, point.base[2] & 4);
  constexpr std::uint64_t eight_blocks = 0x330033;
  const bool is_half = (half & eight_blocks) == 0;
  if (!is_half && !is_empty_block(blocks, point.base)) return false;
  const int edge = is_half ? 4 : 2;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = place.corner[a] + place.half + (point.base[a] & -edge) * (2 * place.half);
    box.max[a] = box.min[a] + edge * (2 * place.half);
  }
  return true;
}

/// The first point that may lie outside of the box. A millionth of a step guards against rounding: a point too many
/// costs time, a point too few would show.
GB_HD double step_beyond(const CastLine& line, const EmptyBox& box, const CastRay& ray) {
  double leave = line.leave + step_length(ray.lod);
  for (int a = 0; a < 3; ++a) {
    if (line.direction[a] == 0) continue;
    const double side = line.direction[a] > 0 ? box.max[a] : box.min[a];
    const double beyond_side = (side - line.origin[a]) * line.inverse[a];
    if (beyond_side < leave) leave = beyond_side;
  }
  const double step = std::ceil((leave - lod_start(line, ray.lod)) * steps_per_voxel(ray.lod) - (0.5 + 1e-6));
  return step > ray.step + 1 ? step : ray.step + 1;
}

/// Where the next level begins at the latest: in the middle of a surface some of its voxels late, since what two levels
/// show of it apart does not add up.
GB_HD double lod_end(const CastLine& line, int lod) { return lod_start(line, lod + 1) + 8 * step_length(lod + 1); }

GB_HD double point_distance(const CastLine& line, int lod, double step) {
  return lod_start(line, lod) + (step + 0.5) * step_length(lod);
}

/// The next level begins behind the surface that the ray was in, or at its own start: how far empty space was stepped
/// over has no say in it.
GB_HD void enter_next_lod(const CastLine& line, CastRay& ray) {
  const double from = point_distance(line, ray.lod, ray.past) - lod_start(line, ray.lod + 1);
  ++ray.lod;
  const double step = std::ceil(from * steps_per_voxel(ray.lod) - 0.5);
  ray.step = step > 0 ? step : 0;
  ray.past = -1;
}

/// In a brick that is coarser than the ray, points lie half a voxel of the brick apart, as far as it stands and the
/// ray's level goes. beyond: the first point that may lie outside of it.
GB_HD double steps_in_coarser(const CastLine& line, const CastPlace& place, const CastRay& ray, double distance,
                              double beyond) {
  double steps = beyond - ray.step;
  const double to_end = std::ceil((lod_end(line, ray.lod) - distance) * steps_per_voxel(ray.lod));
  if (to_end >= 1 && steps > to_end) steps = to_end;
  const double wide = power_of_two(place.lod - ray.lod);
  return steps < wide ? steps : wide;
}

GB_HD void set_point(const CastLine& line, double distance, double p[3]) {
  for (int a = 0; a < 3; ++a) p[a] = line.origin[a] + line.direction[a] * distance;
}

/// What the next point must know of the sheet around this one; there is none where sheet.sheet is 0.
GB_HD void keep_height(const CastSheet& sheet, const CastLine& line, const CastPlace& place, double distance,
                       CastRay& ray) {
  ray.height = CastRay::no_height;
  if (!(sheet.sheet > 0)) return;
  ray.height = sheet.height() * float(2 * place.half);
  ray.height_at = float(distance);
  ray.rise = sheet.rise(line.direction);
}

inline constexpr double met_nowhere = -1;

/// How far behind a point of this height the sheet is met if it goes on as it does there; negative: it was met before.
/// Far beyond all where the ray runs along it.
GB_HD float way_to_sheet(float height, float rise) { return rise == 0 ? CastRay::no_height : -height / rise; }

/// Where the ray met a sheet since the last point, if nothing is around this one: where it would be met if it went on
/// as it does around the last point, no farther from that than points are from each other. A sheet that lies where the
/// field ends shows no change of sign; an offset that is rounded to the border of its voxel can lie there.
GB_HD double sheet_left(const CastRay& ray) {
  if (ray.height == CastRay::no_height) return met_nowhere;
  const float ahead = way_to_sheet(ray.height, ray.rise);
  return ahead > 0 && double(ahead) <= step_length(ray.lod) * (1 + 1e-6) ? double(ray.height_at) + double(ahead)
                                                                         : met_nowhere;
}

/// Where between the last point and this one the ray met a sheet: where its height was 0 or changed its sign. Where the
/// last point was near none the sheet can lie behind it too, as where a level begins: as in sheet_left().
GB_HD double sheet_met(const CastSheet& sheet, const CastLine& line, const CastPlace& place, double distance,
                       const CastRay& ray) {
  if (!(sheet.sheet > 0)) return sheet_left(ray);
  const float height = sheet.height() * float(2 * place.half);
  if (ray.height != CastRay::no_height) {
    if (height == 0) return distance;
    if (!(ray.height * height < 0)) return met_nowhere;
    return distance - (distance - double(ray.height_at)) * double(height / (height - ray.height));
  }
  const float behind = -way_to_sheet(height, sheet.rise(line.direction));
  return behind >= 0 && double(behind) <= step_length(ray.lod) * (1 + 1e-6) ? distance - double(behind) : met_nowhere;
}

/// Between two sheets one behind the other the blended height changes its sign too, from below the first to above the
/// second: there the ray goes down and the height up, or the other way round.
GB_HD bool is_between_sheets(const CastSheet& sheet, const CastLine& line, const CastRay& ray) {
  return ray.height != CastRay::no_height && ray.height * sheet.rise(line.direction) > 0;
}

/// The ray met a sheet at `met`, before the point of `place`: what it looks like there, half a voxel before and half a
/// voxel behind, and how much of it is surface. False: the ray, being patient, waits for what is not here. A ray to a
/// light has no need of what it looks like: it looks once.
template <CastAim aim>
GB_HD bool meet_sheet(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient, double met,
                      CastPlace place, CastPath& path, CastRay& ray) {
  CastSample sample;
  BrickTraits brick;
  double half = 0;
  float across = 1;
  SheetOpacity seen;
  GB_NO_UNROLL
  for (int side = 0; side < (aim == CastAim::eye ? 3 : 1); ++side) {
    double p[3];
    set_point(line, side == 0 ? met : (side == 1 ? met - half : met + half), p);
    if (!place.contains(p)) place = locate(scene, ray.lod, p, patient, place, path);
    if (place.waits && patient) return false;
    if (!is_here(place.brick)) {
      if (side == 0) return true;
      continue;
    }
    const BrickView here = scene.brick(place.brick);
    const CastPoint point = point_in_brick(place, p);
    const CastCorners corners = corners_of(here, point);
    if (side == 0) {
      const CastSheet sheet = blend_planes(corners).sheet;
      if (!(sheet.sheet > 0)) return true;
      seen = opacity_of_sheet(here, point, sheet);
      half = place.half;
      brick = traits_of(place);
      if (seen.density < 1 && is_between_sheets(sheet, line, ray)) return true;
      across = length_along(line.direction, sheet.normal);
    }
    const CastSample more = sheet_sample(corners);
    GB_UNROLL
    for (int k = 0; k < cast_channels; ++k) sample.c[k] += more.c[k];
  }
  if (seen.density < 1) stay_in_surface(met, across, float(2 * half), ray);
  const float covered = covered_in_surface(seen.opacity, seen.density, ray);
  take_light<aim>(sample, brick, stop_light(covered, brick.lod, seen.density, ray), met, 0, camera, ray);
  return true;
}

/// What a ray on its way does next.
enum class CastTask : std::uint8_t {
  seek,  ///< go on over points where the field is zero
  pass,  ///< look at the point where it stands
  meet,  ///< look at the sheet that it met before the point where it stands
  none   ///< it is finished, or waits
};

/// A ray on its way, within a pass. What is left of it afterwards is the CastRay. Its CastPath stands beside it: that
/// is indexed by what a device computes, so it cannot stand in registers as this does.
struct CastWalk {
  CastTask task = CastTask::none;
  double distance = 0;  ///< of the point where it stands
  CastPoint point = {};
  CastPlace place;
};

/// The ray met a sheet before the point where it stands; what that is like comes first.
GB_HD bool is_met(double met, CastWalk& walk, CastRay& ray) {
  if (ray.is_seen || met == met_nowhere) return false;
  ray.met = met;
  walk.task = CastTask::meet;
  return true;
}

/// Goes on by one step, until the ray stands at a point where the field is not zero, or behind a sheet. The ray ends
/// where it leaves the scene, and where it waits, being patient, for what is not here; others let coarser bricks stand
/// for it.
GB_HD void seek_surface(const CastScene& scene, const CastLine& line, bool patient, CastWalk& walk, CastPath& path,
                        CastRay& ray) {
  CastPlace& place = walk.place;
  walk.distance = point_distance(line, ray.lod, ray.step);
  const bool in_surface = ray.step == ray.past;
  // First: a step over what is empty of this level may end behind the scene, where the next level still has a surface.
  const double next_lod = in_surface ? lod_end(line, ray.lod) : lod_start(line, ray.lod + 1);
  if (ray.lod + 1 < scene.lods && walk.distance >= next_lod && next_lod <= line.leave) {
    enter_next_lod(line, ray);
    place = nowhere_in(place.cell);
    return;
  }
  if (walk.distance > line.leave) {
    ray.lod = -1;
    walk.task = CastTask::none;
    return;
  }
  double p[3];
  set_point(line, walk.distance, p);
  if (!place.contains(p)) place = locate(scene, ray.lod, p, patient, place, path);
  if (place.waits && patient) {
    walk.task = CastTask::none;
    return;
  }
  const bool is_brick = is_here(place.brick);
  std::uint64_t blocks = 0;
  if (is_brick) {
    const CastHead head = load_head(scene.heads + place.brick);
    blocks = head.blocks;
    walk.point = point_in_brick(place, p);
    if (!is_zero(blocks, scene.brick(head), walk.point)) {
      walk.task = CastTask::pass;
      return;
    }
  }
  if (is_met(sheet_left(ray), walk, ray)) return;
  ray.is_seen = false;
  ray.height = CastRay::no_height;
  const bool is_wanted = is_brick && place.lod == ray.lod;
  EmptyBox box = empty_box(place);
  if (is_wanted && !find_empty_part(blocks, place, walk.point, box)) {
    ++ray.step;
    return;
  }
  const double beyond = step_beyond(line, box, ray);
  ray.step = is_brick && !is_wanted ? ray.step + steps_in_coarser(line, place, ray, walk.distance, beyond) : beyond;
}

/// Adds what is loose at the point where the ray stands, unless it met a sheet before.
template <CastAim aim>
GB_HD void pass_point(const CastScene& scene, const CastCamera& camera, const CastLine& line, CastWalk& walk,
                      CastRay& ray) {
  const CastPlace& place = walk.place;
  const CastCorners corners = corners_of(scene.brick(place.brick), walk.point);
  const CastAround around = look_around(corners, place.lod == ray.lod);
  const CastSheet& sheet = around.sheet;
  if (is_met(sheet_met(sheet, line, place, walk.distance, ray), walk, ray)) return;
  ray.is_seen = false;
  keep_height(sheet, line, place, walk.distance, ray);
  const CastLoose loose = loose_at(corners, around, line.direction);
  double steps = 1;
  if (place.lod != ray.lod)
    steps = steps_in_coarser(line, place, ray, walk.distance, step_beyond(line, empty_box(place), ray));
  const bool is_loose = loose.sample.mean_coverage() > 0;
  if (is_loose) composite<aim>(loose.sample, loose.pane, line, place, steps, walk.distance, camera, ray);
  ray.step += steps;
  if (is_loose || sheet.sheet > 0) ray.past = ray.step;
  walk.task = ray.transmittance < least_light ? CastTask::none : CastTask::seek;
}

/// Adds the sheet that the ray met, and goes on at the point behind it.
template <CastAim aim>
GB_HD void pass_sheet(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient,
                      CastWalk& walk, CastPath& path, CastRay& ray) {
  const bool is_there = meet_sheet<aim>(scene, camera, line, patient, ray.met, walk.place, path, ray);
  ray.is_seen = is_there;
  walk.task = !is_there || ray.transmittance < least_light ? CastTask::none : CastTask::seek;
}

/// Whether a task is left to any ray of those that a processor takes together. A host takes one; a device a warp, whose
/// lanes must all be here.
GB_HD bool any_ray(bool has_task) {
#if defined(__CUDA_ARCH__)
  return __any_sync(0xffffffffu, has_task ? 1 : 0) != 0;
#else
  return has_task;
#endif
}

/// Whether the rays that a processor takes together seek next, or look at points: what more of them have to do.
GB_HD bool seeks_next(CastTask task) {
#if defined(__CUDA_ARCH__)
  return __popc(__ballot_sync(0xffffffffu, task == CastTask::seek ? 1 : 0)) >=
         __popc(__ballot_sync(0xffffffffu, task == CastTask::pass ? 1 : 0));
#else
  return task == CastTask::seek;
#endif
}

/// So many steps rays seek for before they are asked again what they do next.
inline constexpr int steps_together = 3;

/// Goes on until the ray met a sheet, is finished or waits. Rays that a device takes together seek together and look at
/// points together, whichever more of them wait for; on a device all lanes of a warp call this.
template <CastAim aim = CastAim::eye>
GB_HD void walk_to_sheet(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient,
                         CastWalk& walk, CastPath& path, CastRay& ray) {
  while (any_ray(walk.task == CastTask::seek || walk.task == CastTask::pass)) {
    if (seeks_next(walk.task)) {
      for (int step = 0; step < steps_together && walk.task == CastTask::seek; ++step)
        seek_surface(scene, line, patient, walk, path, ray);
    } else if (walk.task == CastTask::pass) {
      pass_point<aim>(scene, camera, line, walk, ray);
    }
  }
}

/// What a ray does first in a pass. is_cast: false where a device has a lane and no ray.
GB_HD CastTask first_task(bool is_cast, const CastRay& ray) {
  return is_cast && ray.lod >= 0 ? CastTask::seek : CastTask::none;
}

/// Goes on until the ray is finished (lod = -1) or waits. Of rays that a device takes together those that met a sheet
/// wait until all that seek have met one, or are through, since looking at a sheet takes as long as some dozen steps.
/// On a device all lanes of a warp call this.
template <CastAim aim = CastAim::eye>
GB_HD void cast_ray(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient, bool is_cast,
                    CastRay& ray) {
  CastWalk walk;
  CastPath path;
  walk.task = first_task(is_cast, ray);
  while (any_ray(walk.task != CastTask::none)) {
    walk_to_sheet<aim>(scene, camera, line, patient, walk, path, ray);
    if (walk.task == CastTask::meet) pass_sheet<aim>(scene, camera, line, patient, walk, path, ray);
  }
  finish_opaque(ray);
}

/// A rectangle of the picture: ray i is pixel (x + i mod width, y + i div width).
struct CastTile {
  int x = 0, y = 0, width = 0, height = 0;
};

}  // namespace gigabake::kernels
