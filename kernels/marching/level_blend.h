/// Filtering between levels. Near the end of a level's range of distances, a second ray samples the next coarser level.
/// The second ray's weight in the pixel grows to 1 at the distance where the next level begins. This hides the border
/// between levels.
///
/// The second ray is an ordinary ray of a camera whose levels begin nearer. A pixel casts a second ray only if that ray
/// has a weight there. Over most of a level's range, a still image therefore shows only the finer level.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
/// Source  Williams 1983, "Pyramidal Parametrics"; Crassin et al. 2009, "GigaVoxels" (quadrilinear filtering).
#pragma once

#include "core/base/host_device.h"
#include "kernels/marching/cast.h"

namespace gigabake::kernels {

/// The fraction of a level's end distance beyond which the next level has a weight.
inline constexpr double blend_from = 0.7;
/// The factor by which the second ray's levels begin nearer than the first ray's levels. The second ray thus enters the
/// next level before the distance at which that level gets a weight. It leaves the level only after the first ray has
/// entered it.
inline constexpr double coarser_from = 0.6;

GB_HD CastCamera coarser_camera(const CastCamera& camera) {
  CastCamera coarser = camera;
  coarser.lod1_depth *= coarser_from;
  return coarser;
}

/// Returns the distance of the surface that a finished ray hit. This is the point where half of the light is absorbed,
/// or else the last blended surface that the ray hit. Returns 0 if the distance is unknown.
GB_HD double met_distance(const CastRay& ray) {
  if (ray.depth != CastRay::no_depth) return double(ray.depth);
  return ray.transmittance < 1 ? ray.met : 0;
}

/// Returns the weight (0 … 1) of the coarser level in a pixel whose surface is at this distance. `line` is the line of
/// the first ray.
GB_HD float coarser_share(const CastScene& scene, const CastLine& line, double distance) {
  int lod = 0;
  while (lod + 1 < scene.lods && distance >= lod_end(line, lod)) ++lod;
  if (lod + 1 >= scene.lods) return 0;
  const double end = lod_end(line, lod), from = end * blend_from;
  return distance > from ? float((distance - from) / (end - from)) : 0;
}

/// Starts the second ray of a pixel whose first ray is finished. If the first ray hit nothing, the second ray is cast
/// anyway, because voxels of the coarser level are wider and may be hit.
GB_HD CastRay start_coarser(const CastScene& scene, const CastLine& line, const CastLine& coarser_line,
                            const CastRay& ray) {
  const double met = met_distance(ray);
  if (met > 0 && !(coarser_share(scene, line, met) > 0)) return {};
  return start_ray(scene, coarser_line);
}

/// Blends the two finished rays of a pixel. Returns the first ray unchanged if the second one was not needed.
GB_HD CastRay blended(const CastScene& scene, const CastLine& line, const CastRay& ray, const CastRay& coarser) {
  const double met = met_distance(ray), distance = met > 0 ? met : met_distance(coarser);
  const float share = distance > 0 ? coarser_share(scene, line, distance) : 0;
  CastRay out = ray;
  if (!(share > 0)) return out;
  for (int k = 0; k < 3; ++k) out.rgb[k] += (coarser.rgb[k] - ray.rgb[k]) * share;
  out.transmittance += (coarser.transmittance - ray.transmittance) * share;
  if (share >= 0.5f) out.depth = coarser.depth;
  return out;
}

}  // namespace gigabake::kernels
