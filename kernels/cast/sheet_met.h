/// Where a ray meets a sheet: between two points that it looks at, where its height above the sheet changes its sign.
///
/// Space   Lod-0 voxels of the scene's lattice; distances in them too.
/// Exact   IEEE float and double: host and device return the same bits.
#pragma once

#include "kernels/cast/cast_line.h"
#include "kernels/cast/fixed_point.h"
#include "kernels/cast/ray_light.h"
#include "kernels/cast/sheet.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// What the next point must know of the sheet around this one; there is none where sheet.sheet is 0. lod: of the brick.
GB_HD void keep_height(const CastSheet& sheet, const CastLine& line, int lod, double distance, CastRay& ray) {
  ray.height = CastRay::no_height;
  if (!(sheet.sheet > 0)) return;
  ray.height = sheet.height() * short_power_of_two(lod);
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
/// lod: of the brick.
GB_HD double sheet_met(const CastSheet& sheet, const CastLine& line, int lod, double distance, const CastRay& ray) {
  if (!(sheet.sheet > 0)) return sheet_left(ray);
  const float height = sheet.height() * short_power_of_two(lod);
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

}  // namespace gigabake::kernels
