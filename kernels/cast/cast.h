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
#include "kernels/cast/sample.h"
#include "kernels/cast/scene.h"
#include "kernels/cast/sheet.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// A ray on its way. What was not finished goes on from here.
struct CastRay {
  float rgb[3] = {0, 0, 0};  ///< linear, premultiplied
  float transmittance = 1;
  float covered = 0;       ///< coverage of all surface so far, added up: 1 is opaque
  float before = 0;        ///< the same before the surface that the ray is in began
  float apart = 0;         ///< from this distance on another surface begins
  float depth = no_depth;  ///< distance at which half of the light is gone
  std::int32_t lod = -1;   ///< -1: finished
  std::int64_t step = 0;   ///< next point of the level
  std::int64_t past = -1;  ///< the point after the last one of this level that lay in a surface

  float height = no_height;  ///< of the last point above its sheet, lod-0 voxels; no_height: it was near none
  float height_at = 0;       ///< that point's distance
  float ahead = 0;           ///< how far behind it the sheet is met, going on as it does there

  static constexpr float no_depth = 3e38f, no_height = 3e38f;
};

/// e^-x for x ≥ 0 to 2e-5 relative; less than 2e-7 beyond 16.
GB_HD float exp_minus(float x) {
  const float y = (x < 16 ? x : 16) * (-1.0f / 64);
  float e = 1 + y * (1 + y * (0.5f + y * (1.0f / 6 + y * (1.0f / 24 + y * (1.0f / 120)))));
  for (int i = 0; i < 6; ++i) e *= e;
  return e;
}

GB_HD double lod_start(const CastLine& line, int lod) {
  return lod == 0 ? 0 : line.lod1_distance * double(std::int64_t(1) << (lod - 1));
}

GB_HD double step_length(int lod) { return 0.5 * double(std::int64_t(1) << lod); }

GB_HD CastRay start_ray(const CastScene& scene, const CastLine& line) {
  CastRay ray;
  if (!(line.enter <= line.leave)) return ray;
  ray.lod = 0;
  while (ray.lod + 1 < scene.lods && line.enter >= lod_start(line, ray.lod + 1)) ++ray.lod;
  const double step = std::floor((line.enter - lod_start(line, ray.lod)) / step_length(ray.lod) - 0.5);
  ray.step = step > 0 ? std::int64_t(step) : 0;
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

/// Half of a brick along each axis, around the point: false where the field is not zero in all of it.
GB_HD bool find_empty_octant(const CastMask& mask, const CastPlace& place, const CastPoint& point, EmptyBox& box) {
  const int first[3] = {point.base[0] & 4, point.base[1] & 4, point.base[2] & 4};
  std::uint64_t seen = 0;
  for (int z = 0; z < 4; ++z) seen |= mask.word[first[2] + z];
  if ((seen >> (first[0] + 8 * first[1]) & 0x0f0f0f0f) != 0) return false;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = place.corner[a] + place.half + first[a] * (2 * place.half);
    box.max[a] = box.min[a] + 4 * (2 * place.half);
  }
  return true;
}

/// The first point that may lie outside of the box. A millionth of a step guards against rounding: a point too many
/// costs time, a point too few would show.
GB_HD std::int64_t step_beyond(const CastLine& line, const EmptyBox& box, const CastRay& ray) {
  double leave = line.leave + step_length(ray.lod);
  for (int a = 0; a < 3; ++a) {
    if (line.direction[a] == 0) continue;
    const double side = line.direction[a] > 0 ? box.max[a] : box.min[a];
    const double beyond_side = (side - line.origin[a]) * line.inverse[a];
    if (beyond_side < leave) leave = beyond_side;
  }
  const double step = std::ceil((leave - lod_start(line, ray.lod)) / step_length(ray.lod) - (0.5 + 1e-6));
  return step > double(ray.step + 1) ? std::int64_t(step) : ray.step + 1;
}

/// Where the next level begins at the latest: in the middle of a surface some of its voxels late, since what two levels
/// show of it apart does not add up.
GB_HD double lod_end(const CastLine& line, int lod) { return lod_start(line, lod + 1) + 8 * step_length(lod + 1); }

GB_HD double point_distance(const CastLine& line, int lod, std::int64_t step) {
  return lod_start(line, lod) + (double(step) + 0.5) * step_length(lod);
}

/// The next level begins behind the surface that the ray was in, or at its own start: how far empty space was stepped
/// over has no say in it.
GB_HD void enter_next_lod(const CastLine& line, CastRay& ray) {
  const double from = point_distance(line, ray.lod, ray.past) - lod_start(line, ray.lod + 1);
  ++ray.lod;
  const double step = std::ceil(from / step_length(ray.lod) - 0.5);
  ray.step = step > 0 ? std::int64_t(step) : 0;
  ray.past = -1;
}

/// In a brick that is coarser than the ray, points lie half a voxel of the brick apart, as far as it stands and the
/// ray's level goes.
GB_HD std::int64_t steps_in_coarser(const CastLine& line, const CastPlace& place, const CastRay& ray, double distance) {
  EmptyBox box = empty_box(place);
  std::int64_t steps = step_beyond(line, box, ray) - ray.step;
  const double to_end = std::ceil((lod_end(line, ray.lod) - distance) / step_length(ray.lod));
  if (to_end >= 1 && double(steps) > to_end) steps = std::int64_t(to_end);
  const std::int64_t wide = std::int64_t(1) << (place.lod - ray.lod);
  return steps < wide ? steps : wide;
}

/// Six colours and their darker and lighter relations.
GB_HD float painted(std::uint32_t n, int channel) {
  const std::uint32_t hue = n % 6, tone = n / 6 % 3;
  const bool lit = channel == 0 ? hue == 0 || hue == 1 || hue == 5 : (channel == 1 ? hue >= 1 && hue <= 3 : hue >= 3);
  return (lit ? 0.9f : 0.1f) * (1 - 0.3f * float(tone));
}

/// Radiance of a sample: its own, or paint that its own brightness lets the shape show in.
GB_HD void radiance_of(const CastSample& s, const CastPlace& place, CastPaint paint, float rgb[3]) {
  const float scale = 2 / s.mean_coverage();
  for (int k = 0; k < 3; ++k) rgb[k] = s.c[k] * scale;
  if (paint == CastPaint::shaded) return;
  const float grey = 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
  const std::uint32_t n = paint == CastPaint::lod    ? std::uint32_t(place.lod)
                          : paint == CastPaint::cell ? place.cell * 2654435761u >> 20
                                                     : (place.waits ? 0u : 2u);
  for (int k = 0; k < 3; ++k) rgb[k] = painted(n, k) * (0.25f + grey);
}

/// How much surface a ray meets per voxel of its way, from what views along the axes see: |d|·coverage is exact for
/// sheets across an axis and for boxes, the root of squares for spheres. What coarser voxels hold is mostly sheets.
GB_HD float crossings(const CastSample& s, const float across[3], int lod) {
  const float x = s.c[3] * across[0], y = s.c[4] * across[1], z = s.c[5] * across[2];
  const float box = (x + y) + z;
  return lod == 0 ? box : 0.75f * box + 0.25f * std::sqrt((x * x + y * y) + z * z);
}

/// What of the light behind it `covered` hides. Surface is not mist: pieces of a sheet that lie in two voxels add up to
/// an opaque one, where e^-x would let a third through. Coarser voxels are as wide as a pixel, and interpolation
/// spreads their borders over two: the step is steeper there.
///
/// Where surface hides no more than `density` of the light, the step ends there: a sheet shows the alpha that it has.
///
/// Source  Vicini, Jakob, Kaplanyan 2021, "A non-exponential transmittance model for volumetric scene representations".
GB_HD float hidden_by(float covered, int lod, float density) {
  if (lod == 0 || covered >= density) return covered;
  const float part = covered / density;
  return density * (part * part * (3 - 2 * part));
}

/// What of the light that came so far stops where the ray has now met `covered` of surface, of a brick of level `lod`.
GB_HD float stop_light(float covered, int lod, float density, CastRay& ray) {
  const float before = hidden_by(ray.covered, lod, density);
  ray.covered = covered < 1 ? covered : 1;
  if (before >= 1) return ray.transmittance;
  const float more = (hidden_by(ray.covered, lod, density) - before) / (1 - before);
  return more > 0 ? ray.transmittance * more : 0;
}

/// Pieces of a pane that a ray meets are one until it is so many voxels away from them, across the pane.
inline constexpr float pane_reach = 2;

/// The ray is in a surface at `distance`, which it leaves so fast. voxel: edge of its voxels.
GB_HD void stay_in_surface(double distance, float across, float voxel, CastRay& ray) {
  if (float(distance) >= ray.apart) ray.before = ray.covered;
  constexpr float slowest = 1.0f / 32;
  ray.apart = float(distance) + pane_reach * voxel / (across > slowest ? across : slowest);
}

/// After `more` of a surface that hides no more than `density`: how many of a pane's voxels a ray meets depends on the
/// slope, and together they hide what the pane does. Pieces of an opaque surface add up.
GB_HD float covered_in_surface(float more, float density, const CastRay& ray) {
  const float covered = ray.covered + more;
  if (density >= 1) return covered;
  const float most = ray.before + (1 - ray.before) * density;
  return covered <= most ? covered : (most > ray.covered ? most : ray.covered);
}

/// A brick that stands for finer ones which are not here counts as more surface than it holds, the more the coarser it
/// is: where it borders on one of another level neither holds the whole of a surface that passes through both, and
/// ground that lets the sky through is worse than an edge that is too thick until the rest comes.
GB_HD float solidity(const CastPlace& place, const CastRay& ray) { return float(1 + place.lod - ray.lod); }

/// `weight` of the light that started stops at the sample, which stands for `way` around `distance`.
GB_HD void take_light(const CastSample& s, const CastPlace& place, float weight, double distance, double way,
                      const CastCamera& camera, CastRay& ray) {
  const float seen = exp_minus(float(distance) * camera.haze.per_voxel);
  float rgb[3];
  radiance_of(s, place, camera.paint, rgb);
  for (int k = 0; k < 3; ++k) ray.rgb[k] += weight * (rgb[k] * seen + camera.haze.rgb[k] * (1 - seen));
  if (ray.depth == CastRay::no_depth && ray.transmittance - weight < 0.5f)
    ray.depth = float(distance) + float(way) * ((ray.transmittance - 0.5f) / weight - 0.5f);
  ray.transmittance -= weight;
}

/// The sample stands for `steps` points of the ray's level.
GB_HD void composite(const CastSample& s, const CastPane& pane, const CastLine& line, const CastPlace& place,
                     std::int64_t steps, double distance, const CastCamera& camera, CastRay& ray) {
  const double way = double(steps) * step_length(ray.lod);
  const float part = solidity(place, ray) * float(way / (2 * place.half));
  if (pane.density < 1) stay_in_surface(distance, pane.across, float(2 * place.half), ray);
  const float covered = covered_in_surface(crossings(s, line.across, place.lod) * part, pane.density, ray);
  take_light(s, place, stop_light(covered, place.lod, 1, ray), distance, way, camera, ray);
}

/// What is still to come would not show: the ray ends as if the last surface were opaque.
GB_HD void finish_opaque(CastRay& ray) {
  const float scale = 1 / (1 - ray.transmittance);
  for (float& channel : ray.rgb) channel *= scale;
  ray.transmittance = 0;
  ray.lod = -1;
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
  ray.ahead = float(sheet.way(line.direction) * (2 * place.half));
}

inline constexpr double met_nowhere = -1;

/// Where between the last point and this one the ray met a sheet: where its height was 0 or changed its sign. A sheet
/// that lies where the field ends shows no change: where the last point was near none, or this one is, it is met if it
/// would be when it went on as it does around the other point, no farther from that than points are from each other.
/// An offset that is rounded to the border of its voxel can lie there; so can the sheet where a level begins.
GB_HD double sheet_met(const CastSheet& sheet, const CastLine& line, const CastPlace& place, double distance,
                       const CastRay& ray) {
  const bool was_near = ray.height != CastRay::no_height, is_near = sheet.sheet > 0;
  const double step = step_length(ray.lod) * (1 + 1e-6);
  if (was_near && is_near) {
    const float height = sheet.height() * float(2 * place.half);
    if (height == 0) return distance;
    if (!(ray.height * height < 0)) return met_nowhere;
    return distance - (distance - double(ray.height_at)) * double(height / (height - ray.height));
  }
  if (was_near) return ray.ahead > 0 && ray.ahead <= step ? double(ray.height_at) + double(ray.ahead) : met_nowhere;
  if (!is_near) return met_nowhere;
  const double behind = -sheet.way(line.direction) * (2 * place.half);
  return behind >= 0 && behind <= step ? distance - behind : met_nowhere;
}

/// Between two sheets one behind the other the blended height changes its sign too, from below the first to above the
/// second: there the ray goes down and the height up, or the other way round.
GB_HD bool is_between_sheets(const CastSheet& sheet, const CastLine& line, const CastRay& ray) {
  double rises = 0;
  for (int a = 0; a < 3; ++a) rises += double(sheet.normal[a]) * line.direction[a];
  return ray.height != CastRay::no_height && double(ray.height) * rises > 0;
}

/// The ray met a sheet at `met`, before the point of `around`. False: as step_ray().
GB_HD bool meet_sheet(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient, double met,
                      const CastPlace& around, CastPath& path, CastRay& ray) {
  double p[3];
  set_point(line, met, p);
  const CastPlace place = around.contains(p) ? around : locate(scene, ray.lod, p, patient, around, path);
  if (place.waits && patient) return false;
  if (!is_here(place.brick)) return true;
  const CastPoint point = point_in_brick(place, p);
  const CastVoxel* voxels = scene.voxels + std::size_t(slot_voxels) * place.brick;
  const CastSheet sheet = blend_planes(voxels, point);
  if (!(sheet.sheet > 0)) return true;
  CastSample sample = sheet_sample(voxels, point);
  for (int side = -1; side <= 1; side += 2) {
    double q[3];
    set_point(line, met + side * place.half, q);
    const CastPlace at = place.contains(q) ? place : locate(scene, ray.lod, q, patient, place, path);
    if (at.waits && patient) return false;
    if (!is_here(at.brick)) continue;
    const CastSample more = sheet_sample(scene.voxels + std::size_t(slot_voxels) * at.brick, point_in_brick(at, q));
    for (int k = 0; k < cast_channels; ++k) sample.c[k] += more.c[k];
  }
  const SheetOpacity seen = opacity_of_sheet(voxels, point, sheet);
  if (seen.density < 1) {
    if (is_between_sheets(sheet, line, ray)) return true;
    stay_in_surface(met, length_along(line.direction, sheet.normal), float(2 * place.half), ray);
  }
  const float covered = covered_in_surface(seen.opacity, seen.density, ray);
  take_light(sample, place, stop_light(covered, place.lod, seen.density, ray), met, 0, camera, ray);
  return true;
}

/// Nothing is at this point: a sheet that was met since the last one was so beyond the field's end. False: as
/// step_ray().
GB_HD bool leave_sheet(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient,
                       double distance, const CastPlace& place, CastPath& path, CastRay& ray) {
  const double met = sheet_met({}, line, place, distance, ray);
  if (met != met_nowhere && !meet_sheet(scene, camera, line, patient, met, place, path, ray)) return false;
  ray.height = CastRay::no_height;
  return true;
}

/// What is at this point, which stands for `steps` of its level. False: as step_ray().
GB_HD bool add_point(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient,
                     double distance, std::int64_t steps, const CastPoint& point, const CastPlace& place,
                     CastPath& path, CastRay& ray) {
  const CastVoxel* voxels = scene.voxels + std::size_t(slot_voxels) * place.brick;
  const CastField field = field_at(voxels, point, place.lod, place.lod == ray.lod, line.direction);
  const bool is_loose = field.loose.mean_coverage() > 0;
  const double met = sheet_met(field.sheet, line, place, distance, ray);
  if (met != met_nowhere && !meet_sheet(scene, camera, line, patient, met, place, path, ray)) return false;
  keep_height(field.sheet, line, place, distance, ray);
  if (!is_loose && !(field.sheet.sheet > 0)) return true;
  if (is_loose) composite(field.loose, field.pane, line, place, steps, distance, camera, ray);
  ray.past = ray.step + steps;
  return true;
}

/// Looks at one point and goes on to the next one worth looking at. False: the ray, being patient, waits for what is
/// not here; others let coarser bricks stand for it.
GB_HD bool step_ray(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient,
                    double distance, CastPlace& place, CastPath& path, CastRay& ray) {
  double p[3];
  set_point(line, distance, p);
  if (!place.contains(p)) place = locate(scene, ray.lod, p, patient, place, path);
  if (place.waits && patient) return false;
  if (!is_here(place.brick)) {
    if (!leave_sheet(scene, camera, line, patient, distance, place, path, ray)) return false;
    ray.step = step_beyond(line, empty_box(place), ray);
    return true;
  }
  const std::int64_t steps = place.lod == ray.lod ? 1 : steps_in_coarser(line, place, ray, distance);
  const CastPoint point = point_in_brick(place, p);
  const CastMask& mask = scene.masks[place.brick];
  if (!is_zero(mask, point)) {
    if (!add_point(scene, camera, line, patient, distance, steps, point, place, path, ray)) return false;
  } else if (!leave_sheet(scene, camera, line, patient, distance, place, path, ray)) {
    return false;
  } else if (EmptyBox box; place.lod == ray.lod && find_empty_octant(mask, place, point, box)) {
    ray.step = step_beyond(line, box, ray);
    return true;
  }
  ray.step += steps;
  return true;
}

/// Goes on until the ray is finished (lod = -1) or waits.
GB_HD void cast_ray(const CastScene& scene, const CastCamera& camera, const CastLine& line, bool patient,
                    CastRay& ray) {
  CastPlace place;
  CastPath path;
  while (ray.lod >= 0) {
    const double distance = point_distance(line, ray.lod, ray.step);
    const bool in_surface = ray.step == ray.past;
    if (distance > line.leave) {
      ray.lod = -1;
    } else if (ray.lod + 1 < scene.lods &&
               distance >= (in_surface ? lod_end(line, ray.lod) : lod_start(line, ray.lod + 1))) {
      enter_next_lod(line, ray);
      place = CastPlace();
    } else if (!step_ray(scene, camera, line, patient, distance, place, path, ray)) {
      return;
    } else if (ray.transmittance < 1.0f / 1024) {
      finish_opaque(ray);
    }
  }
}

/// A rectangle of the picture: ray i is pixel (x + i mod width, y + i div width).
struct CastTile {
  int x = 0, y = 0, width = 0, height = 0;
};

}  // namespace gigabake::kernels
