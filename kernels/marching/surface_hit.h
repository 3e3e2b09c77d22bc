/// Intersection of a ray with a blended surface: the sign change of the signed distance between two samples of the ray.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double: host and device return the same bits.
#pragma once

#include "core/base/host_device.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/fixed_point.h"
#include "kernels/marching/ray_light.h"
#include "kernels/marching/surface_blend.h"

namespace gigabake::kernels {

/// Stores the surface's signed distance and slope at this sample in the ray, for the intersection test at the next
/// sample. Stores no_signed_distance if this sample has no blended surface (`blend.weight` = 0). `lod` is the level of
/// the brick.
GB_HD void keep_signed_distance(const SurfaceBlend& blend, const CastLine& line, int lod, double distance,
                                CastRay& ray) {
  const float before = ray.signed_distance;
  ray.signed_distance = CastRay::no_signed_distance;
  ray.normal = 0;
  if (!(blend.weight > 0)) return;
  ray.signed_distance = blend.signed_distance() * short_power_of_two(lod);
  if (before == CastRay::no_signed_distance)
    ray.is_behind = ray.signed_distance < 0;
  else if (before * ray.signed_distance < 0)
    ray.is_behind = !ray.is_behind;
  ray.signed_distance_at = float(distance);
  ray.surface_lod = std::uint8_t(lod);
  ray.slope = blend.slope(line.direction);
  const float scale = 1 / blend.weight;
  ray.normal = byte_vector(int(blend.normal[0] * scale), int(blend.normal[1] * scale), int(blend.normal[2] * scale));
}

inline constexpr double met_nowhere = -1;

/// Returns the distance along the ray from a sample to the surface, extrapolated linearly. The distance is negative if
/// the ray passes the surface before it reaches the sample. Returns a very large value if the ray runs parallel to the
/// surface.
GB_HD float distance_to_surface(float signed_distance, float slope) {
  return slope == 0 ? CastRay::no_signed_distance : -signed_distance / slope;
}

/// Extrapolates the surface of the previous sample linearly if the current sample has none. Returns the distance of the
/// hit if it lies within one step, of the level of that sample's brick, after the previous sample; else met_nowhere.
/// Without extrapolation, a ray would miss a surface at the end of the field, because no sample follows behind this
/// surface. A plane whose offset is rounded to the voxel's border has this effect.
GB_HD double extrapolated_hit(const CastRay& ray) {
  if (ray.signed_distance == CastRay::no_signed_distance) return met_nowhere;
  const float ahead = distance_to_surface(ray.signed_distance, ray.slope);
  return ahead > 0 && double(ahead) <= step_length(ray.surface_lod) * (1 + 1e-6)
             ? double(ray.signed_distance_at) + double(ahead)
             : met_nowhere;
}

/// Returns the distance of the ray's hit between the previous sample and this sample, or met_nowhere. The ray hits the
/// surface if the signed distance is 0 at this sample or has changed its sign. If the previous sample had no surface
/// (for example at the start of a level), the function extrapolates backwards by at most one step of the brick's level.
/// If this sample has no surface, it returns extrapolated_hit(). `lod` is the level of the brick.
GB_HD double surface_hit_distance(const SurfaceBlend& blend, const CastLine& line, int lod, double distance,
                                  const CastRay& ray) {
  if (!(blend.weight > 0)) return extrapolated_hit(ray);
  const float signed_distance = blend.signed_distance() * short_power_of_two(lod);
  if (ray.signed_distance != CastRay::no_signed_distance) {
    if (signed_distance == 0) return distance;
    if (!(ray.signed_distance * signed_distance < 0)) return met_nowhere;
    return distance - (distance - double(ray.signed_distance_at)) *
                          double(signed_distance / (signed_distance - ray.signed_distance));
  }
  const float behind = -distance_to_surface(signed_distance, blend.slope(line.direction));
  if (!(behind >= 0 && double(behind) <= step_length(lod) * (1 + 1e-6))) return met_nowhere;
  const double met = distance - double(behind);
  return lod != ray.lod && met < line.enter ? met_nowhere : met;  // the voxels of a leaf may contain the eye
}

/// Tests whether a sign change is an artefact between two surfaces, one behind the other. Between the two surfaces, the
/// blended distance changes its sign although the ray moves away from the nearer surface. The slope then has the sign
/// of the previous distance.
GB_HD bool is_between_surfaces(const SurfaceBlend& blend, const CastLine& line, const CastRay& ray) {
  return ray.signed_distance != CastRay::no_signed_distance && ray.signed_distance * blend.slope(line.direction) > 0;
}

}  // namespace gigabake::kernels
