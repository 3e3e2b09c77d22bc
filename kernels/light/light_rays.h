/// The light of a pixel: the visible fractions of the sun and the sky at its surface.
///
/// A pixel's surface is where half of its ray's light is absorbed. One cone leads from this surface to the sun, and one
/// to the sky. Not every pixel casts these cones: neighbouring pixels share results (kernels/light/shadow_reuse.h). A
/// cone is an ordinary ray whose levels have voxels as wide as the cone, but not finer than the pixel's level. The cone
/// requests missing data, and surfaces absorb it. The width of the voxels through which a cone passes determines the
/// width of a shadow's border.
///
/// In directions in which the sky is hidden, other surfaces are assumed to send the light of the ground. An unshadowed
/// surface of any slope therefore receives the same light as in shaded_radiance().
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
/// Source  Crassin et al. 2011, "Interactive Indirect Illumination Using Voxel Cone Tracing".
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/light/light_start.h"
#include "kernels/light/lighting.h"
#include "kernels/light/surface_point.h"
#include "kernels/marching/cast.h"
#include "kernels/marching/seen_side.h"

namespace gigabake::kernels {

GB_HD int lod_at(const CastScene& scene, const CastLine& line, double distance) {
  int lod = 0;
  while (lod + 1 < scene.lods && distance >= lod_start(line, lod + 1)) ++lod;
  return lod;
}

/// Sums over voxels, weighted by interpolation weight and coverage.
struct SurfaceSums {
  float weight = 0;
  float facing = 0, up = 0;                ///< of the side to which the normals point
  float facing_behind = 0, up_behind = 0;  ///< of the other side
  float before = 0;                        ///< signed distance of the sample before the hit
  Vec3<float> normal{0, 0, 0};
};

/// The voxels around a hit: those whose normals point towards the eye, and the others.
struct HitSums {
  SurfaceSums front, back;
};

/// Adds a voxel of weight `by` and unit normal `n`. The other arguments are its `before`, and the cosine between its
/// normal and the direction to the sun.
GB_HD void add_voxel(float by, const Vec3<float>& n, float signed_distance, float cosine, SurfaceSums& sums) {
  sums.weight += by;
  sums.normal += n * by;
  sums.before += by * signed_distance;
  sums.facing += by * (cosine > 0 ? cosine : 0);
  sums.facing_behind += by * (cosine < 0 ? -cosine : 0);
  sums.up += by * (0.5f + 0.5f * n[2]);
  sums.up_behind += by * (0.5f - 0.5f * n[2]);
}

/// Adds the eight voxels around a point. A voxel without a normal sees the whole sky and no sun, as in
/// shaded_radiance(). `is_before` is true at the sample before the hit. Each voxel is added to both sums, with weight 0
/// to one of them, because a device cannot keep sums with a computed address in registers.
GB_HD void add_surface(const CastCorners& corners, const Vec3<float>& direction, const Vec3<float>& to_sun,
                       bool is_before, HitSums& hit) {
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    const CastVoxel voxel = corners.stored(c);
    const int covered = (voxel.c[3] + voxel.c[4]) + voxel.c[5];
    if (covered == 0) continue;
    const float by = corners.weight(c) * float(covered);
    if (normal_of(voxel) == 0) {
      hit.front.weight += by;
      hit.front.up += by;
      continue;
    }
    Vec3<float> n = vector_of_normal(voxel);
    n = n * (1 / std::sqrt(dot(n, n)));
    const bool is_back = dot(n, direction) > 0;
    const float signed_distance = is_before ? signed_distance_to(corners, c, voxel) : 0, cosine = dot(n, to_sun);
    add_voxel(is_back ? 0 : by, n, signed_distance, cosine, hit.front);
    add_voxel(is_back ? by : 0, n, signed_distance, cosine, hit.back);
  }
}

/// The min fraction of the voxels around a hit whose normals point towards the eye, so that they are the surface that
/// the eye sees. The other voxels then belong to a surface that these hide, such as the far side of a ridge.
inline constexpr float min_front = 0.125f;

/// Sets `normal`, `facing` and `up` of the pixel's surface, for the side that the eye sees. If most normals point away
/// from the eye, the eye sees their other side, unless the sample before the hit lies on the side of the normals: a ray
/// that passes behind an edge of a solid object. The surface faces the eye if the voxels have no normals or if their
/// normals cancel.
GB_HD void set_surface(const HitSums& hit, const CastLine& line, PixelLight& light) {
  const bool is_front = hit.front.weight >= min_front * (hit.front.weight + hit.back.weight);
  const bool is_behind = !is_front && hit.back.before < 0;
  const float weight = is_front ? hit.front.weight : hit.back.weight;
  const float facing = is_front ? hit.front.facing : (is_behind ? hit.back.facing_behind : hit.back.facing);
  const float up = is_front ? hit.front.up : (is_behind ? hit.back.up_behind : hit.back.up);
  const Vec3<float> normal =
      Vec3<float>::by_axis([&](int a) { return is_front ? hit.front.normal[a] : hit.back.normal[a]; });
  light.facing = weight > 0 ? facing / weight : 0;
  light.up = weight > 0 ? up / weight : 1;
  const float length = std::sqrt(dot(normal, normal));
  light.normal =
      length > 0 ? normal / (is_behind ? -length : length) : static_cast<Vec3<float>>(line.direction) * -1.0f;
}

/// Finds the surface that the pixel's finished ray hit. Samples the surface at the hit and half a voxel before and
/// behind the hit. If `blocking` is true and the data has been evicted, returns false: the pixel must wait.
GB_HD bool find_surface(const CastScene& scene, const CastLighting& lighting, const CastLine& line, bool blocking,
                        const CastRay& ray, PixelLight& light) {
  light.has_surface = ray.depth != CastRay::no_depth;
  if (!light.has_surface) return true;
  light.depth = ray.depth;
  light.lod = lod_at(scene, line, double(ray.depth));
  LevelSampler at(scene, line, light.lod);
  CastPath path;
  HitSums sums;
  const Vec3<float> direction = static_cast<Vec3<float>>(line.direction);
  GB_NO_UNROLL
  for (int side = -1; side <= 1; ++side) {
    at.look(scene, line, double(ray.depth) + side * step_length(light.lod), blocking, path);
    if (at.place.waits && blocking) return false;
    if (is_resident(at.place.brick))
      add_surface(corners_of(scene.brick(at.place.brick), at.point()), direction, lighting.light.to_sun, side < 0,
                  sums);
  }
  light.at = static_cast<Vec3<float>>(line.direction * double(ray.depth));
  set_surface(sums, line, light);
  return true;
}

/// Tests whether the result of this ray affects the pixel. At an edge of two surfaces, the mean normal may point away
/// from the sun although one of the surfaces faces it. The pixel then receives no light from the sun.
GB_HD bool lights_up(const PixelLight& light, const Vec3<float>& direction, LightRay ray) {
  if (!light.has_surface || !(direction[2] > 0)) return false;
  const float cosine = dot(light.normal, direction);
  return ray == LightRay::sun ? light.facing > 0 && cosine > 0 : cosine > min_cosine;
}

/// Tests whether a pixel casts this ray in the first round. In the second round, other pixels can reuse the shadow
/// samples of the first round. Rays to the sky are cast first by every other pixel, in a checkerboard
/// pattern. Rays to the sun are cast first by every other pixel of every other row.
GB_HD bool is_cast_first(int x, int y, LightRay ray) {
  return place_in_block(x, y) < (ray == LightRay::sun ? sky_block * sky_block / 4 : sky_directions);
}

/// Returns the line from the surface to a light, which begins at `start`.
GB_HD CastLine line_to_light(const CastScene& scene, const CastCamera& camera, const PixelLight& light,
                             const Vec3<float>& direction, double lod1, const LightStart& start) {
  CastLine line;
  line.enter = start.distance;
  line.leave = double(far_voxel);
  line.lod1_distance = lod1;
  // Beyond this border around the voxels, only coarser levels have a field, and that field must not cast shadows.
  const double border = 2 * power_of_two(light.lod);
  for (int a = 0; a < 3; ++a) {
    const double d = direction[a];
    set_direction(line, a, d);
    line.origin[a] = camera.eye[a] + double(light.at[a]) + double(light.normal[a] * start.lift) +
                     d * (double(start.along) - start.distance);
    clip_to_box(line, a, larger_of(scene.min[a] - border, camera.clip.min[a]),
                smaller_of(scene.max[a] + border, camera.clip.max[a]));
  }
  clip_to_plane(line, camera.clip);  // clipped parts cast no shadows
  return line;
}

/// Casts the pixel's ray `which` from its start, until it is finished or waits. The pixel's surface must be known. On a
/// device all lanes of a warp must call this function; `is_cast` is false if a lane has no ray.
GB_HD void cast_to_light(const CastScene& scene, const CastCamera& camera, const CastLighting& lighting, int x, int y,
                         LightRay which, bool blocking, bool is_cast, PixelLight& light) {
  CastLine line{};
  CastRay ray;
  if (is_cast) {
    const bool is_sun = which == LightRay::sun;
    const Vec3<float>& direction = light_direction(lighting, x, y, which);
    const double lod1 = is_sun ? lighting.sun_lod1 : lighting.sky_lod1;
    const LightStart start = light_start(light, direction, lod1, is_sun);
    line = line_to_light(scene, camera, light, direction, lod1, start);
    ray = start_ray(scene, line);
    is_cast = cover_start(scene, camera, light, direction, start, blocking, ray);
  }
  cast_ray<RayType::shadow>(scene, camera, line, blocking, is_cast, ray);
  if (!is_cast || ray.lod >= 0) return;
  light.seen[int(which)] = ray.transmittance;
  light.done |= 1u << int(which);
}

/// Calls find_surface() if the surface is not known, and selects the rays to light that the pixel casts first.
GB_HD void find_surface_once(const CastScene& scene, const CastLighting& lighting, const CastLine& line, bool blocking,
                             const CastRay& ray, int x, int y, PixelLight& light) {
  if (light.has(light_rays) || !find_surface(scene, lighting, line, blocking, ray, light)) return;
  for (int r = 0; lighting.part != CastLightPart::unshadowed && r < light_rays; ++r) {
    const auto which = LightRay(r);
    if (is_cast_first(x, y, which) && lights_up(light, light_direction(lighting, x, y, which), which))
      light.first |= 1u << r;
  }
  light.done = PixelLight::all & ~light.first;
}

/// Runs one pass of a pixel's rays to the light. Results that the pass stores are final.
GB_HD void light_pixel(const CastScene& scene, const CastCamera& camera, const CastLighting& lighting,
                       const CastLine& line, const CastRay& ray, int x, int y, bool blocking, PixelLight& light) {
  find_surface_once(scene, lighting, line, blocking, ray, x, y, light);
  for (int r = 0; light.has(light_rays) && r < light_rays; ++r)
    if (!light.has(r)) cast_to_light(scene, camera, lighting, x, y, LightRay(r), blocking, true, light);
}

}  // namespace gigabake::kernels
