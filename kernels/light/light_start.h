/// The start of a ray to the light. A ray to the light starts above its surface, because the interpolated field of the
/// surface would otherwise absorb it. Other surfaces between the surface and this start, such as the ceiling next to a
/// wall, absorb the ray on its path from the surface to the start.
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

/// The distance from the surface, in voxels, at which the path to the start of a ray leaves the pixel's line of sight.
/// Points of the line of sight lie on the side that the eye sees, also in corners, where the surface lies in the field
/// of another surface.
inline constexpr float free_sight = 1;

/// The path from a point of the pixel's line of sight to the start of a ray.
struct StartPath {
  CastLine line;                ///< `leave` is its length
  Vec3<float> direction;        ///< of the line
  float above, rise_per_voxel;  ///< distance of the first point from the pixel's surface in voxels, and its change
};

GB_HD StartPath path_to_start(const CastCamera& camera, const PixelLight& light, const Vec3<float>& direction,
                              const LightStart& start) {
  const float back = free_sight * float(power_of_two(light.lod));
  const Vec3<float> before = light.at * (light.depth > back ? 1 - back / light.depth : 0),
                    to_surface = light.at - before;
  const Vec3<float> to = to_surface + light.normal * start.lift + direction * start.along;
  const float length = std::sqrt(dot(to, to));
  StartPath path;
  path.direction = to / length;
  path.above = -dot(light.normal, to_surface) * float(power_of_two(-light.lod));
  path.rise_per_voxel = dot(light.normal, path.direction);
  path.line.enter = 0;
  path.line.leave = double(length);
  path.line.lod1_distance = 0;
  for (int a = 0; a < 3; ++a) {
    set_direction(path.line, a, double(path.direction[a]));
    path.line.origin[a] = camera.eye[a] + double(before[a]);
  }
  return path;
}

/// Adds to `ray` the coverage of other surfaces between the pixel's line of sight and the start of the ray. Samples lie
/// half a voxel apart. Only the half of a surface that lies ahead of a sample counts, so it counts twice. If `blocking`
/// is true and data is missing, returns false: the ray must wait.
GB_HD bool cover_start(const CastScene& scene, const CastCamera& camera, const PixelLight& light,
                       const Vec3<float>& direction, const LightStart& start, bool blocking, CastRay& ray) {
  if (start.along == 0) return true;
  const double step = step_length(light.lod);
  const float voxels = float(power_of_two(-light.lod));
  const StartPath to_start = path_to_start(camera, light, direction, start);
  LevelSampler at(scene, to_start.line, light.lod);
  CastPath path;
  float covered = 0;
  GB_NO_UNROLL
  for (double along = step / 2; along < to_start.line.leave; along += step) {
    at.look(scene, to_start.line, along, blocking, path);
    if (at.place.waits && blocking) return false;
    if (!is_resident(at.place.brick) || at.place.lod != light.lod) continue;
    const float above = to_start.above + float(along) * voxels * to_start.rise_per_voxel;
    covered += coverage_ahead(corners_of(scene.brick(at.place.brick), at.point()), light, to_start.direction, above);
  }
  ray.covered = covered < 1 ? covered : 1;
  ray.transmittance = 1 - ray.covered;
  if (ray.transmittance < transmittance_cutoff) ray.lod = -1;
  return true;
}

}  // namespace gigabake::kernels
