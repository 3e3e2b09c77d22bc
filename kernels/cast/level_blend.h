/// Filtering between levels: towards the end of a level's distances a second ray, which is one level coarser there, has
/// a growing share of the pixel, and all of it where the next level begins. So no level ends at a line.
///
/// The second ray is a ray as any other, of a camera whose levels begin nearer; only pixels that it has a share of cast
/// it. A still picture keeps the finer voxels over most of a level's distances.
///
/// Space   Lod-0 voxels of the scene's lattice; distances in them too.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
/// Source  Williams 1983, "Pyramidal Parametrics"; Crassin et al. 2009, "GigaVoxels" (quadrilinear filtering).
#pragma once

#include "kernels/cast/cast.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// From this part of the distance at which a level ends on, the next one has a share.
inline constexpr double blend_from = 0.7;
/// Levels of the second ray begin at so much of the distance: it has entered the next one before that has a share, and
/// leaves it behind where the first ray enters it.
inline constexpr double coarser_from = 0.6;

GB_HD CastCamera coarser_camera(const CastCamera& camera) {
  CastCamera coarser = camera;
  coarser.lod1_depth *= coarser_from;
  return coarser;
}

/// Where a finished ray met surface: where half of its light was gone, or else its last sheet. 0: nobody knows.
GB_HD double met_distance(const CastRay& ray) {
  if (ray.depth != CastRay::no_depth) return double(ray.depth);
  return ray.transmittance < 1 ? ray.met : 0;
}

/// What share of a pixel whose surface is at this distance the coarser level has, 0 … 1. line: of the first ray.
GB_HD float coarser_share(const CastScene& scene, const CastLine& line, double distance) {
  int lod = 0;
  while (lod + 1 < scene.lods && distance >= lod_end(line, lod)) ++lod;
  if (lod + 1 >= scene.lods) return 0;
  const double end = lod_end(line, lod), from = end * blend_from;
  return distance > from ? float((distance - from) / (end - from)) : 0;
}

/// The second ray of a pixel whose first one is finished. Where that met nothing, the coarser level still may: voxels
/// are wider there.
GB_HD CastRay start_coarser(const CastScene& scene, const CastLine& line, const CastLine& coarser_line,
                            const CastRay& ray) {
  const double met = met_distance(ray);
  if (met > 0 && !(coarser_share(scene, line, met) > 0)) return {};
  return start_ray(scene, coarser_line);
}

/// Both rays of a pixel, finished. One that needed no second ray stays as it is.
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
