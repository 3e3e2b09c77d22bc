/// Compositing along a ray: coverage, transmittance, colour and depth.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/cast_camera.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/cast_ray.h"
#include "kernels/marching/locate.h"
#include "kernels/marching/sample.h"
#include "kernels/marching/surface_blend.h"

namespace gigabake::kernels {

/// Returns a channel of debug colour n: six hues in three brightnesses. Not inlined, because few images show debug
/// colours.
GB_HD_NOINLINE float debug_color(std::uint32_t n, int channel) {
  const std::uint32_t hue = n % 6, tone = n / 6 % 3;
  const bool lit = channel == 0 ? hue == 0 || hue == 1 || hue == 5 : (channel == 1 ? hue >= 1 && hue <= 3 : hue >= 3);
  return (lit ? 0.9f : 0.1f) * (1 - 0.3f * float(tone));
}

/// The properties of a sample's brick that debug colours show.
struct BrickTraits {
  std::int32_t lod = 0;
  std::uint32_t cell = no_cell;
  bool waits = false;
};

GB_HD std::uint32_t debug_color_index(const BrickTraits& brick, DebugColor debug) {
  if (debug == DebugColor::lod) return std::uint32_t(brick.lod);
  return debug == DebugColor::cell ? brick.cell * 2654435761u >> 20 : (brick.waits ? 0u : 2u);
}

/// Computes a sample's radiance, or a debug colour scaled by the sample's brightness so that shapes remain visible.
GB_HD void radiance_of(const CastSample& s, const BrickTraits& brick, DebugColor debug, Vec3<float>& rgb) {
  const float scale = 2 / s.mean_coverage();
  for (int k = 0; k < 3; ++k) rgb[k] = s.c[k] * scale;
  if (debug == DebugColor::shaded) return;
  const float grey = 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
  const std::uint32_t n = debug_color_index(brick, debug);
  GB_UNROLL
  for (int k = 0; k < 3; ++k) rgb[k] = debug_color(n, k) * (0.25f + grey);
}

/// Returns the amount of surface per voxel of ray length, estimated from the coverages along the axes. Each axis
/// contributes the product |component of the direction|·coverage. The sum of these products is exact for boxes and for
/// surfaces perpendicular to an axis. The root of the sum of their squares is exact for spheres. Coarse voxels contain
/// mostly flat surfaces, so their estimate is 3/4 box and 1/4 sphere.
GB_HD float crossings(const CastSample& s, const Vec3d& direction, int lod) {
  const float x = s.c[3] * std::fabs(float(direction[0]));
  const float y = s.c[4] * std::fabs(float(direction[1]));
  const float z = s.c[5] * std::fabs(float(direction[2]));
  const float box = (x + y) + z;
  return lod == 0 ? box : 0.75f * box + 0.25f * std::sqrt((x * x + y * y) + z * z);
}

/// Returns the opacity of accumulated coverage. Opacity is linear, not exponential: fragments of one surface in two
/// voxels must sum to opaque, while e^-x would transmit a third. Voxels of coarser levels are as wide as a pixel, and
/// interpolation spreads their borders over two voxels; a steeper step compensates for this.
///
/// If the surface's own opacity `density` is below 1, the step spans 0 to `density` instead of 0 to 1.
///
/// Source  Vicini, Jakob, Kaplanyan 2021, "A non-exponential transmittance model for volumetric scene representations".
GB_HD float hidden_by(float covered, int lod, float density) {
  if (lod == 0 || covered >= density) return covered;
  const float part = covered / density;
  return density * (part * part * (3 - 2 * part));
}

/// Returns the absorbed light, as a fraction of the light at the ray's start, when the ray's coverage rises to
/// `covered`. Updates ray.covered. `lod` is the level of the brick.
GB_HD float stop_light(float covered, int lod, float density, CastRay& ray) {
  const float before = hidden_by(ray.covered, lod, density);
  ray.covered = covered < 1 ? covered : 1;
  if (before >= 1) return ray.transmittance;
  const float more = (hidden_by(ray.covered, lod, density) - before) / (1 - before);
  return more > 0 ? ray.transmittance * more : 0;
}

/// The distance in voxels, measured across the surface, within which translucent samples count as one surface.
inline constexpr float merge_distance_voxels = 2;

/// Extends the current surface by the sample at `distance`, or starts a new surface. `across` is |cosine| of the angle
/// between ray and normal. `voxel` is the edge of the surface's voxels.
GB_HD void stay_in_surface(double distance, float across, float voxel, CastRay& ray) {
  if (float(distance) >= ray.apart) ray.before = ray.covered;
  constexpr float slowest = 1.0f / 32;
  ray.apart = float(distance) + merge_distance_voxels * voxel / (across > slowest ? across : slowest);
}

/// Returns the sum of the ray's coverages after another sample of a surface with opacity `density`; `more` is the
/// coverage of that sample. Coverages of an opaque surface add up. A translucent surface covers at most the fraction
/// `density` of the light that reaches it. Without this limit its opacity would depend on the slope, because a ray hits
/// more of its voxels at a flat angle.
GB_HD float covered_in_surface(float more, float density, const CastRay& ray) {
  const float covered = ray.covered + more;
  if (density >= 1) return covered;
  const float maximum = ray.before + (1 - ray.before) * density;
  return covered <= maximum ? covered : (maximum > ray.covered ? maximum : ray.covered);
}

/// Returns the opacity scale of a fallback brick. The scale grows with the difference between the brick's level and the
/// ray's level. At the border to a brick of another level, neither brick contains the whole surface. Too much coverage
/// makes edges too thick until finer data is resident; too little would leave holes in the ground.
GB_HD float fallback_opacity_scale(const BrickTraits& brick, const CastRay& ray) {
  return float(1 + brick.lod - ray.lod);
}

/// The type of a ray.
enum class RayType : std::uint8_t {
  primary,  ///< primary ray: computes colours and depth
  lit,      ///< primary ray in a scene with CastScene::is_lit: lights surfaces on the side that it meets
  shadow    ///< shadow ray: computes only the transmittance, with the same bits as a primary ray
};

/// Composites a sample that absorbs the fraction `weight` of the initial light. The sample represents the length
/// `length` around `distance`.
template <RayType ray_type>
GB_HD void composite_sample(const CastSample& s, const BrickTraits& brick, float weight, double distance, double length,
                            const CastCamera& camera, CastRay& ray) {
  if constexpr (ray_type == RayType::shadow) {
    ray.transmittance -= weight;
    return;
  }
  const float seen = exp_minus(float(distance) * camera.haze.per_voxel);
  Vec3<float> rgb;
  radiance_of(s, brick, camera.debug_color, rgb);
  for (int k = 0; k < 3; ++k) ray.rgb[k] += weight * (rgb[k] * seen + camera.haze.rgb[k] * (1 - seen));
  if (ray.depth == CastRay::no_depth && ray.transmittance - weight < 0.5f)
    ray.depth = float(distance) + float(length) * ((ray.transmittance - 0.5f) / weight - 0.5f);
  ray.transmittance -= weight;
}

/// Composites a sample that represents `steps` samples of the ray's level.
template <RayType ray_type>
GB_HD void composite(const CastSample& s, const TranslucentSurface& translucent, const CastLine& line,
                     const BrickTraits& brick, double steps, double distance, const CastCamera& camera, CastRay& ray) {
  const double length = steps * step_length(ray.lod);
  const float part = fallback_opacity_scale(brick, ray) * float(length * power_of_two(-brick.lod));
  if (translucent.density < 1) stay_in_surface(distance, translucent.across, short_power_of_two(brick.lod), ray);
  const float covered = covered_in_surface(crossings(s, line.direction, brick.lod) * part, translucent.density, ray);
  composite_sample<ray_type>(s, brick, stop_light(covered, brick.lod, 1, ray), distance, length, camera, ray);
}

inline constexpr float transmittance_cutoff = 1.0f / 1024;

/// Finishes the ray if its transmittance is too low to be visible, as if the last surface were opaque.
GB_HD void finish_opaque(CastRay& ray) {
  if (ray.lod < 0 || ray.transmittance >= transmittance_cutoff) return;
  const float scale = 1 / (1 - ray.transmittance);
  for (float& channel : ray.rgb) channel *= scale;
  ray.transmittance = 0;
  ray.lod = -1;
}

}  // namespace gigabake::kernels
