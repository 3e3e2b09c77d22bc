/// Intersection of a ray with a blended surface: the sign change of the signed distance between two samples of the ray.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double: host and device return the same bits.
#pragma once

#include "core/base/host_device.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/fixed_point.h"
#include "kernels/marching/ray_light.h"
#include "kernels/marching/sheet.h"

namespace gigabake::kernels {

/// Stores the surface's signed distance and slope at this sample in the ray, for the intersection test at the next
/// sample. Stores no_height if this sample has no blended surface (`sheet.sheet` = 0). `lod` is the level of the brick.
GB_HD void keep_height(const CastSheet& sheet, const CastLine& line, int lod, double distance, CastRay& ray) {
  ray.height = CastRay::no_height;
  if (!(sheet.sheet > 0)) return;
  ray.height = sheet.height() * short_power_of_two(lod);
  ray.height_at = float(distance);
  ray.rise = sheet.rise(line.direction);
}

inline constexpr double met_nowhere = -1;

/// Returns the distance along the ray from a sample to the surface, extrapolated linearly. The distance is negative if
/// the ray passes the surface before it reaches the sample. Returns a very large value if the ray runs parallel to the
/// surface.
GB_HD float way_to_sheet(float height, float rise) { return rise == 0 ? CastRay::no_height : -height / rise; }

/// Extrapolates the surface of the previous sample linearly if the current sample has none. Returns the distance of the
/// hit if it lies within one step after the previous sample, otherwise met_nowhere. Without extrapolation, a ray would
/// miss a surface at the end of the field, because no sample follows behind this surface. A plane whose offset is
/// rounded to the voxel's border has this effect.
GB_HD double extrapolated_hit(const CastRay& ray) {
  if (ray.height == CastRay::no_height) return met_nowhere;
  const float ahead = way_to_sheet(ray.height, ray.rise);
  return ahead > 0 && double(ahead) <= step_length(ray.lod) * (1 + 1e-6) ? double(ray.height_at) + double(ahead)
                                                                         : met_nowhere;
}

/// Returns the distance of the ray's hit between the previous sample and this sample, or met_nowhere. The ray hits the
/// surface if the signed distance is 0 at this sample or has changed its sign. If the previous sample had no surface
/// (for example at the start of a level), the function extrapolates backwards by at most one step. If this sample has
/// no surface, it returns extrapolated_hit(). `lod` is the level of the brick.
GB_HD double sheet_met(const CastSheet& sheet, const CastLine& line, int lod, double distance, const CastRay& ray) {
  if (!(sheet.sheet > 0)) return extrapolated_hit(ray);
  const float height = sheet.height() * short_power_of_two(lod);
  if (ray.height != CastRay::no_height) {
    if (height == 0) return distance;
    if (!(ray.height * height < 0)) return met_nowhere;
    return distance - (distance - double(ray.height_at)) * double(height / (height - ray.height));
  }
  const float behind = -way_to_sheet(height, sheet.rise(line.direction));
  return behind >= 0 && double(behind) <= step_length(ray.lod) * (1 + 1e-6) ? distance - double(behind) : met_nowhere;
}

/// Tests whether a sign change is an artefact between two surfaces, one behind the other. Between the two surfaces, the
/// blended distance changes its sign although the ray moves away from the nearer surface. The slope then has the sign
/// of the previous distance.
GB_HD bool is_between_sheets(const CastSheet& sheet, const CastLine& line, const CastRay& ray) {
  return ray.height != CastRay::no_height && ray.height * sheet.rise(line.direction) > 0;
}

}  // namespace gigabake::kernels
