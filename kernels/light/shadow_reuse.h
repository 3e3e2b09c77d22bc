/// Reuse of shadow samples among neighbouring pixels.
///
/// Some pixels cast their rays to light first. Every other pixel reuses the samples around it or casts its own rays.
/// This choice depends only on first rays in the pixel's region. The result therefore does not depend on the order of
/// pixels or on tiles, if tiles begin where regions do.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/light/light_rays.h"
#include "kernels/light/surface_point.h"

namespace gigabake::kernels {

/// The visibility of the sun from some pixels around a pixel: pixels that cast a ray to the sun first and show the same
/// surface.
struct SunSeen {
  int pixels = 0;
  float sum = 0, minimum = 1, maximum = 0;

  /// Tests whether the samples are uniform. At least three pixels must see the whole sun, or at least three must see
  /// none of it, to within 1/64; no pixel may differ.
  GB_HD bool is_uniform() const {
    constexpr int enough = 3;
    constexpr float bound = 1.0f / 64;
    return pixels >= enough && (minimum >= 1 - bound || maximum <= bound);
  }
};

/// Returns the samples of the four pixels around pixel (x, y) that cast a ray to the sun first, two on each axis.
GB_HD SunSeen sun_around(const TileLights& tile, int x, int y, const PixelLight& own) {
  const LightWindow window = window_around(tile.tile, 1, sun_block, x, y);
  SunSeen sun;
  for (int j = window.y0; j < window.y1; ++j)
    for (int i = window.x0; i < window.x1; ++i) {
      const PixelLight& other = tile.at(i, j);
      if (!other.is_first(LightRay::sun) || !is_same_surface(own, other)) continue;
      const float seen = other.seen[int(LightRay::sun)];
      ++sun.pixels;
      sun.sum += seen;
      if (seen < sun.minimum) sun.minimum = seen;
      if (seen > sun.maximum) sun.maximum = seen;
    }
  return sun;
}

/// Reuses shadow samples in pixel (x, y) of the tile, after all first rays are finished. `light` is the light of this
/// pixel. If the samples are not uniform, marks the pixel's own ray for casting. Reads only results of first rays,
/// which no call writes, so pixels may be processed concurrently.
GB_HD void reuse_shadow_samples(const TileLights& tile, const CastLighting& lighting, int x, int y, PixelLight& light) {
  if (!light.has(light_rays) || lighting.part == CastLightPart::unshadowed) return;
  std::uint32_t then = 0;
  for (int r = 0; r < light_rays; ++r) {
    const auto which = LightRay(r);
    const Vec3<float>& direction = light_direction(lighting, tile.tile.x + x, tile.tile.y + y, which);
    if (light.is_first(which) || !lights_up(light, direction, which)) continue;
    bool is_uniform = false;
    if (which == LightRay::sun) {
      const SunSeen sun = sun_around(tile, x, y, light);
      is_uniform = sun.is_uniform();
      if (is_uniform) light.seen[r] = sun.sum / float(sun.pixels);
    } else {
      float share;
      is_uniform = sky_around(tile, lighting, x, y, light, SkyRays::first, share);
    }
    if (!is_uniform) then |= 1u << r;
  }
  light.then = then;
  light.done &= ~then;
}

}  // namespace gigabake::kernels
