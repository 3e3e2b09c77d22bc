/// The start of a ray to the light. A ray to the light starts above its surface, because the interpolated field of the
/// surface would otherwise absorb it. Other surfaces between the surface and this start, such as the ceiling next to a
/// wall, absorb the ray as if it started at the surface.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/light/surface_point.h"
#include "kernels/marching/cast.h"
#include "kernels/marching/seen_side.h"

namespace gigabake::kernels {

/// The distance above the surface, in voxels of the pixel's level, at which a ray to the light starts. The interpolated
/// field of the surface does not reach this far.
inline constexpr float light_clearance = 1.5f;

/// The start of a ray to the light, relative to the surface.
struct LightStart {
  float cosine;     ///< between the surface's normal and the ray
  float lift;       ///< along the normal
  float along;      ///< along the ray
  double distance;  ///< from the cone's tip; the cone is as wide there as the pixel's voxels
};

/// Returns a start light_clearance above the surface. For the sky, the start is moved along the normal. For the sun,
/// whose shadows have sharp borders, it is moved along the ray; at grazing angles, the rest of the clearance is added
/// along the normal. `lod1` is the distance from the tip at which the cone is as wide as a lod-1 voxel.
GB_HD LightStart light_start(const PixelLight& light, const Vec3<float>& direction, double lod1, bool is_sun) {
  const float clearance = light_clearance * float(power_of_two(light.lod));
  const float cosine = dot(light.normal, direction);
  const float along = !is_sun ? 0 : (cosine > 0.25f ? clearance / cosine : 4 * clearance);
  const float left = clearance - (cosine > 0 ? along * cosine : 0);
  return {cosine, left > 0 ? left : 0, along, light.lod == 0 ? 0 : lod1 * power_of_two(light.lod - 1)};
}

/// The min distance of a voxel's centre in front of the pixel's surface, in voxels, from which on the voxel belongs to
/// another surface. Voxels of the pixel's surface may be half a voxel in front of it.
inline constexpr float min_before_plane = 0.6f;
/// The max squared cosine between the normals of two surfaces: 30°.
inline constexpr float max_squared_cosine = 0.75f;

/// Tests whether a voxel belongs to another surface than the pixel's, in front of it, and lies ahead of the point. `to`
/// leads from the point to the voxel's centre, and `above` is the point's distance from the pixel's surface, both in
/// voxels.
GB_HD bool is_ahead(const CastVoxel& voxel, const PixelLight& light, const Vec3<float>& direction,
                    const Vec3<float>& to, float above) {
  if (above + dot(light.normal, to) < min_before_plane) return false;
  const Vec3<float> n = vector_of_normal(voxel);
  const float cosine = dot(n, light.normal);
  return cosine * cosine <= max_squared_cosine * dot(n, n) && dot(n, to) * dot(n, direction) > 0;
}

/// Returns the coverage, in a view along `direction`, of the voxels around a point for which is_ahead() is true.
GB_HD float coverage_ahead(const CastCorners& corners, const PixelLight& light, const Vec3<float>& direction,
                           float above) {
  float covered = 0;
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    const CastVoxel voxel = corners.stored(c);
    const Vec3<float> centre{float(c & 1), float(c >> 1 & 1), float(c >> 2)};
    if (!is_ahead(voxel, light, direction, centre - corners.between, above)) continue;
    const float box = (voxel.c[3] * std::fabs(direction[0]) + voxel.c[4] * std::fabs(direction[1])) +
                      voxel.c[5] * std::fabs(direction[2]);
    covered += corners.weight(c) * box * (1.0f / 65535);
  }
  return covered;
}

/// Adds to `ray` the coverage of other surfaces between the pixel's surface and the start of the ray. Samples lie half
/// a voxel apart. Only the half of a surface that lies ahead of a sample counts, so it counts twice. If `blocking` is
/// true and data is missing, returns false: the ray must wait.
GB_HD bool cover_start(const CastScene& scene, const CastLine& line, const PixelLight& light,
                       const Vec3<float>& direction, const LightStart& start, bool blocking, CastRay& ray) {
  const double step = step_length(light.lod);
  const float voxels = float(power_of_two(-light.lod));
  LevelSampler at(scene, line, light.lod);
  CastPath path;
  float covered = 0;
  GB_NO_UNROLL
  for (double along = step / 2; along < double(start.along); along += step) {
    at.look(scene, line, start.distance - double(start.along) + along, blocking, path);
    if (at.place.waits && blocking) return false;
    if (!is_resident(at.place.brick) || at.place.lod != light.lod) continue;
    const float above = (start.lift + float(along) * start.cosine) * voxels;
    covered += coverage_ahead(corners_of(scene.brick(at.place.brick), at.point()), light, direction, above);
  }
  ray.covered = covered < 1 ? covered : 1;
  ray.transmittance = 1 - ray.covered;
  if (ray.transmittance < transmittance_cutoff) ray.lod = -1;
  return true;
}

}  // namespace gigabake::kernels
