/// What of a ray's light stops where, and what it brings back.
///
/// Space   Lod-0 voxels of the scene's lattice; distances in them too.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/cast/cast_camera.h"
#include "kernels/cast/cast_line.h"
#include "kernels/cast/locate.h"
#include "kernels/cast/sample.h"
#include "kernels/cast/sheet.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// A ray on its way. What was not finished goes on from here.
struct alignas(16) CastRay {
  float rgb[3] = {0, 0, 0};  ///< linear, premultiplied
  float transmittance = 1;
  float covered = 0;       ///< coverage of all surface so far, added up: 1 is opaque
  float before = 0;        ///< the same before the surface that the ray is in began
  float apart = 0;         ///< from this distance on another surface begins
  float depth = no_depth;  ///< distance at which half of the light is gone
  double step = 0;         ///< next point of the level; a whole number, as `past` is
  double past = -1;        ///< the point after the last one of this level that lay in a surface

  double met = 0;            ///< distance at which it met a sheet before the point where it stands
  float height = no_height;  ///< of the last point above its sheet, lod-0 voxels; no_height: it was near none
  float height_at = 0;       ///< that point's distance
  float rise = 0;            ///< how much higher the ray gets along a lod-0 voxel, going on as it does there
  std::int32_t lod = -1;     ///< -1: finished
  bool is_seen = false;      ///< the sheet at `met` has been looked at

  static constexpr float no_depth = 3e38f, no_height = 3e38f;
};

/// e^-x for x ≥ 0 to 2e-5 relative; less than 2e-7 beyond 16.
GB_HD float exp_minus(float x) {
  const float y = (x < 16 ? x : 16) * (-1.0f / 64);
  float e = 1 + y * (1 + y * (0.5f + y * (1.0f / 6 + y * (1.0f / 24 + y * (1.0f / 120)))));
  for (int i = 0; i < 6; ++i) e *= e;
  return e;
}

/// Six colours and their darker and lighter relations. One copy: few pictures are painted.
GB_HD_ONE_COPY float painted(std::uint32_t n, int channel) {
  const std::uint32_t hue = n % 6, tone = n / 6 % 3;
  const bool lit = channel == 0 ? hue == 0 || hue == 1 || hue == 5 : (channel == 1 ? hue >= 1 && hue <= 3 : hue >= 3);
  return (lit ? 0.9f : 0.1f) * (1 - 0.3f * float(tone));
}

/// What paint tells of the brick that a sample is from.
struct BrickTraits {
  std::int32_t lod = 0;
  std::uint32_t cell = no_cell;
  bool waits = false;
};

GB_HD std::uint32_t paint_number(const BrickTraits& brick, CastPaint paint) {
  if (paint == CastPaint::lod) return std::uint32_t(brick.lod);
  return paint == CastPaint::cell ? brick.cell * 2654435761u >> 20 : (brick.waits ? 0u : 2u);
}

/// Radiance of a sample: its own, or paint that its own brightness lets the shape show in.
GB_HD void radiance_of(const CastSample& s, const BrickTraits& brick, CastPaint paint, float rgb[3]) {
  const float scale = 2 / s.mean_coverage();
  for (int k = 0; k < 3; ++k) rgb[k] = s.c[k] * scale;
  if (paint == CastPaint::shaded) return;
  const float grey = 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
  const std::uint32_t n = paint_number(brick, paint);
  GB_UNROLL
  for (int k = 0; k < 3; ++k) rgb[k] = painted(n, k) * (0.25f + grey);
}

/// How much surface a ray meets per voxel of its way, from what views along the axes see: |d|·coverage is exact for
/// sheets across an axis and for boxes, the root of squares for spheres. What coarser voxels hold is mostly sheets.
GB_HD float crossings(const CastSample& s, const double direction[3], int lod) {
  const float x = s.c[3] * std::fabs(float(direction[0]));
  const float y = s.c[4] * std::fabs(float(direction[1]));
  const float z = s.c[5] * std::fabs(float(direction[2]));
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
GB_HD float solidity(const BrickTraits& brick, const CastRay& ray) { return float(1 + brick.lod - ray.lod); }

/// What a ray is cast for.
enum class CastAim : std::uint8_t {
  eye,   ///< what it meets: colours and depth
  light  ///< how much of a light comes through, and nothing else; the same bits as the eye's ray has of that
};

/// `weight` of the light that started stops at the sample, which stands for `way` around `distance`.
template <CastAim aim>
GB_HD void take_light(const CastSample& s, const BrickTraits& brick, float weight, double distance, double way,
                      const CastCamera& camera, CastRay& ray) {
  if constexpr (aim == CastAim::light) {
    ray.transmittance -= weight;
    return;
  }
  const float seen = exp_minus(float(distance) * camera.haze.per_voxel);
  float rgb[3];
  radiance_of(s, brick, camera.paint, rgb);
  for (int k = 0; k < 3; ++k) ray.rgb[k] += weight * (rgb[k] * seen + camera.haze.rgb[k] * (1 - seen));
  if (ray.depth == CastRay::no_depth && ray.transmittance - weight < 0.5f)
    ray.depth = float(distance) + float(way) * ((ray.transmittance - 0.5f) / weight - 0.5f);
  ray.transmittance -= weight;
}

/// The sample stands for `steps` points of the ray's level.
template <CastAim aim>
GB_HD void composite(const CastSample& s, const CastPane& pane, const CastLine& line, const BrickTraits& brick,
                     double steps, double distance, const CastCamera& camera, CastRay& ray) {
  const double way = steps * step_length(ray.lod);
  const float part = solidity(brick, ray) * float(way * power_of_two(-brick.lod));
  if (pane.density < 1) stay_in_surface(distance, pane.across, short_power_of_two(brick.lod), ray);
  const float covered = covered_in_surface(crossings(s, line.direction, brick.lod) * part, pane.density, ray);
  take_light<aim>(s, brick, stop_light(covered, brick.lod, 1, ray), distance, way, camera, ray);
}

inline constexpr float least_light = 1.0f / 1024;

/// What is still to come would not show: the ray ends as if the last surface were opaque.
GB_HD void finish_opaque(CastRay& ray) {
  if (ray.lod < 0 || ray.transmittance >= least_light) return;
  const float scale = 1 / (1 - ray.transmittance);
  for (float& channel : ray.rgb) channel *= scale;
  ray.transmittance = 0;
  ray.lod = -1;
}

}  // namespace gigabake::kernels
