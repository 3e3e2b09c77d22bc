/// Reuse of shadow samples within blocks of pixels, and the light that a pixel shows.
///
/// Some pixels cast their rays to light first. Each other pixel reuses these samples or casts its own rays, depending
/// only on the first rays of its block. The result therefore does not depend on the order of pixels or on tiles, if
/// tiles begin where blocks do.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/light/light_rays.h"

namespace gigabake::kernels {

/// Tests whether two pixels show the same surface and therefore receive the same light.
GB_HD bool is_same_surface(const PixelLight& a, const PixelLight& b) {
  if (!b.has_surface || !(dot3(a.normal, b.normal) > 0.9f)) return false;
  const float to[3] = {b.at[0] - a.at[0], b.at[1] - a.at[1], b.at[2] - a.at[2]};
  const float above = dot3(a.normal, to);
  return (above < 0 ? -above : above) <= 2 * float(power_of_two(a.lod));
}

/// The light of a tile's pixels, row by row.
struct TileLights {
  const PixelLight* lights;
  CastTile tile;

  GB_HD const PixelLight& at(int x, int y) const {
    return lights[std::size_t(y) * std::size_t(tile.width) + std::size_t(x)];
  }
};

/// Pixels of a tile: [min, max).
struct LightBlock {
  int x0, y0, x1, y1;
};

/// Returns the block of edge × edge pixels around pixel (x, y) of a tile, clipped to the tile.
/// Range   The tile begins at a multiple of `edge` in the image.
GB_HD LightBlock block_around(const CastTile& tile, int edge, int x, int y) {
  const int x0 = x / edge * edge, y0 = y / edge * edge;
  return {x0, y0, x0 + edge < tile.width ? x0 + edge : tile.width, y0 + edge < tile.height ? y0 + edge : tile.height};
}

/// Visibility of the sun from the pixels of a block that cast a ray to the sun first and show the same surface.
struct SunSeen {
  int pixels = 0;
  float sum = 0, minimum = 1, maximum = 0;

  /// Tests whether the samples are uniform: at least three pixels, which all see (to within 1/64) the whole sun or none
  /// of it.
  GB_HD bool is_told() const {
    constexpr int enough = 3;
    constexpr float bound = 1.0f / 64;
    return pixels >= enough && (minimum >= 1 - bound || maximum <= bound);
  }
};

GB_HD SunSeen sun_around(const TileLights& tile, int x, int y, const PixelLight& own) {
  const LightBlock block = block_around(tile.tile, sun_block, x, y);
  SunSeen sun;
  for (int j = block.y0; j < block.y1; ++j)
    for (int i = block.x0; i < block.x1; ++i) {
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

/// The set of rays to the sky that a sum includes.
enum class SkyRays : std::int32_t { first, all };

/// Computes the visible fraction of the sky from the rays of the block's pixels that show the surface. Returns false if
/// there are none.
GB_HD bool sky_around(const TileLights& tile, const CastLighting& lighting, int x, int y, const PixelLight& own,
                      SkyRays rays, float& share) {
  const LightBlock block = block_around(tile.tile, sky_block, x, y);
  float seen = 0, all = 0;
  for (int j = block.y0; j < block.y1; ++j)
    for (int i = block.x0; i < block.x1; ++i) {
      const PixelLight& other = tile.at(i, j);
      const bool counts = rays == SkyRays::first ? other.is_first(LightRay::sky) : other.is_cast(LightRay::sky);
      if (!counts || !is_same_surface(own, other)) continue;
      const float* direction = light_direction(lighting, tile.tile.x + i, tile.tile.y + j, LightRay::sky);
      const float by = dot3(own.normal, direction);
      if (!(by > min_cosine)) continue;
      seen += by * other.seen[int(LightRay::sky)];
      all += by;
    }
  share = all > 0 ? seen / all : 1;
  return all > 0;
}

/// Reuses shadow samples in pixel (x, y) of the tile, after all first rays are finished. light: of this pixel. If the
/// samples are not uniform, marks the pixel's own ray for casting. Reads only results of first rays, which no call
/// writes, so pixels may be processed concurrently.
GB_HD void share_light(const TileLights& tile, const CastLighting& lighting, int x, int y, PixelLight& light) {
  if (!light.has(light_rays) || lighting.part == CastLightPart::unhidden) return;
  std::uint32_t then = 0;
  for (int r = 0; r < light_rays; ++r) {
    const auto which = LightRay(r);
    const float* direction = light_direction(lighting, tile.tile.x + x, tile.tile.y + y, which);
    if (light.is_first(which) || !lights_up(light, direction, which)) continue;
    bool is_told = false;
    if (which == LightRay::sun) {
      const SunSeen sun = sun_around(tile, x, y, light);
      is_told = sun.is_told();
      if (is_told) light.seen[r] = sun.sum / float(sun.pixels);
    } else {
      float share;
      is_told = sky_around(tile, lighting, x, y, light, SkyRays::first, share);
    }
    if (!is_told) then |= 1u << r;
  }
  light.then = then;
  light.done &= ~then;
}

/// Returns the light for a pixel that shows little surface: the light of a pixel of its block that has one. Returns
/// unshadowed light if the block has no such pixel.
GB_HD PixelLight light_beside(const TileLights& tile, const CastLighting& lighting, int x, int y) {
  const LightBlock block = block_around(tile.tile, sun_block, x, y);
  for (int j = block.y0; j < block.y1; ++j)
    for (int i = block.x0; i < block.x1; ++i)
      if (tile.at(i, j).has_surface) return tile.at(i, j);
  PixelLight open;
  open.facing = lighting.light.to_sun[2] > 0 ? lighting.light.to_sun[2] : 0;
  open.seen[int(LightRay::sun)] = 1;
  return open;
}

/// The surface that a pixel shows, and its light.
struct SurfacePoint {
  double place[3];  ///< lod-0 voxels of the scene's lattice
  float normal[3];  ///< unit; towards the eye if the voxels have none
  float distance;   ///< from the eye
  float own[3];     ///< own colour: linear RGB, premultiplied by `there`
  float there;      ///< fraction of the pixel that is surface, above 0
  float facing;     ///< mean of max(0, cosine between the sun's direction and the normal)
  float sun_seen;   ///< visible fraction of the sun; 1 if no rays are cast to the light
  float sky_seen;   ///< visible fraction of the sky: 1/2 for an open wall, 1 for open flat ground
};

/// Returns the surface of pixel i of a tile, whose ray contains the surface's own colour. tile: finished light of the
/// pixels.
/// Range   ray.transmittance < 1.
GB_HD SurfacePoint surface_point(const CastRay& ray, const double eye[3], const TileLights& tile,
                                 const CastLighting& lighting, std::size_t i) {
  const int x = int(i % std::size_t(tile.tile.width)), y = int(i / std::size_t(tile.tile.width));
  const PixelLight own = tile.at(x, y).has_surface ? tile.at(x, y) : light_beside(tile, lighting, x, y);
  const bool is_cast = lighting.part != CastLightPart::unhidden;
  float sky = 1;
  if (is_cast) sky_around(tile, lighting, x, y, own, SkyRays::all, sky);
  SurfacePoint at;
  for (int a = 0; a < 3; ++a) {
    at.place[a] = eye[a] + double(own.at[a]);
    at.normal[a] = own.normal[a];
    at.own[a] = ray.rgb[a];
  }
  at.distance = own.depth;
  at.there = 1 - ray.transmittance;
  at.facing = own.facing;
  at.sun_seen = is_cast ? own.seen[int(LightRay::sun)] : 1;
  at.sky_seen = own.up * sky;
  return at;
}

}  // namespace gigabake::kernels
