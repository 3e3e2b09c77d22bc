/// The surface that a pixel shows and the light at this surface, after all rays of the tile are finished.
///
/// Space   Coordinates and distances are lod-0 voxels of the scene's lattice.
/// Exact   IEEE float and double, no transcendental functions: host and device return the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/light/lighting.h"
#include "kernels/marching/cast_ray.h"
#include "kernels/marching/voxel_space.h"

namespace gigabake::kernels {

/// A pixel's rays to the light.
enum class LightRay : std::int32_t { sun, sky };
inline constexpr int light_rays = 2;

/// The light at a pixel's surface.
struct PixelLight {
  Vec3<float> normal{0, 0, 1};  ///< normal of the side that the eye sees, unit vector
  Vec3<float> at{0, 0, 0};      ///< position relative to the eye
  float depth = 0;
  float facing = 0;             ///< mean of max(0, cosine between the sun's direction and the normal)
  float up = 1;                 ///< fraction of the sky that the surface would see without occluders
  float seen[light_rays] = {};  ///< by ray: fraction of the light that is visible
  std::int32_t lod = 0;         ///< the ray's level at distance `depth`
  std::uint32_t done = 0;       ///< bit r: ray r is finished or not cast; bit light_rays: the surface is known
  std::uint32_t first = 0;      ///< bit r: ray r is cast before shadow samples are reused
  std::uint32_t then = 0;       ///< bit r: ray r is cast afterwards, because the samples are not uniform
  bool has_surface = false;     ///< false: the ray lost less than half of its light

  static constexpr std::uint32_t all = (2u << light_rays) - 1;
  GB_HD bool has(int bit) const { return (done >> bit & 1) != 0; }
  GB_HD bool is_first(LightRay ray) const { return (first >> int(ray) & 1) != 0; }
  GB_HD bool is_cast(LightRay ray) const { return ((first | then) >> int(ray) & 1) != 0; }
};

/// The min cosine of the angle between the normal and a direction to the sky. Light from directions of a smaller cosine
/// contributes almost nothing.
inline constexpr float min_cosine = 1.0f / 32;

/// Returns the rank (0 to 63) of pixel (x, y) of the image in its block of sky_block × sky_block; ranks of neighbours
/// differ strongly.
GB_HD int place_in_block(int x, int y) {
  return int(dither_rank(std::uint32_t(x) % sky_block, std::uint32_t(y) % sky_block));
}

/// Returns the direction to the light for a ray of pixel (x, y) of the image. The pixel's position in its block
/// determines the part of the sun or the sky.
GB_HD const Vec3<float>& light_direction(const CastLighting& lighting, int x, int y, LightRay ray) {
  constexpr int places_per_direction = sky_block * sky_block / sun_directions;
  const int place = place_in_block(x, y);
  return ray == LightRay::sun ? lighting.sun[place / places_per_direction] : lighting.sky[place % sky_directions];
}

/// Tests whether two pixels show the same surface and therefore receive the same light. Their normals must differ by
/// less than 26°, and pixel b must lie within a voxel of the plane of pixel a.
GB_HD bool is_same_surface(const PixelLight& a, const PixelLight& b) {
  if (!b.has_surface || !(dot(a.normal, b.normal) > 0.9f)) return false;
  const float above = dot(a.normal, b.at - a.at);
  return (above < 0 ? -above : above) <= float(power_of_two(a.lod));
}

/// The light of a tile's pixels, row by row.
struct TileLights {
  const PixelLight* lights;
  CastTile tile;

  GB_HD const PixelLight& at(int x, int y) const {
    return lights[std::size_t(y) * std::size_t(tile.width) + std::size_t(x)];
  }
};

/// A rectangle of pixels of a tile: [x0, x1) × [y0, y1).
struct LightWindow {
  int x0, y0, x1, y1;
};

/// The light of a pixel depends only on pixels of its region of light_region × light_region pixels of the image. Images
/// therefore do not depend on tiles, if tiles begin where regions do.
inline constexpr int light_region = 128;

/// The pixels [low, high) of one axis.
struct LightRange {
  int low, high;
};

/// Returns `edge` pixels of one axis of a tile, from `before` pixels before pixel `at` on, moved into the region of
/// this pixel. Returns the whole region if it is smaller. The tile has `size` pixels on this axis.
GB_HD LightRange range_around(int at, int before, int edge, int size) {
  const int region = at / light_region * light_region;
  const int end = region + light_region < size ? region + light_region : size;
  int low = at - before;
  if (low + edge > end) low = end - edge;
  if (low < region) low = region;
  return {low, low + edge < end ? low + edge : end};
}

/// Returns the window of edge × edge pixels around pixel (x, y) of a tile, moved into the region of this pixel.
/// Wherever a window of sky_block pixels lies, its pixels sample each direction to the sky once. Windows of neighbours
/// share most of their pixels, so light changes gradually from pixel to pixel.
/// Range   The tile begins at multiples of light_region in the image.
GB_HD LightWindow window_around(const CastTile& tile, int before, int edge, int x, int y) {
  const LightRange across = range_around(x, before, edge, tile.width),
                   down = range_around(y, before, edge, tile.height);
  return {across.low, down.low, across.high, down.high};
}

/// The set of rays to the sky that a sum includes.
enum class SkyRays : std::int32_t { first, all };

/// Sets `share` to the visible fraction of the sky at pixel (x, y). Evaluates the rays from those pixels of its window
/// that show the same surface. If there are no such rays, returns false and sets `share` to 1.
GB_HD bool sky_around(const TileLights& tile, const CastLighting& lighting, int x, int y, const PixelLight& own,
                      SkyRays rays, float& share) {
  const LightWindow window = window_around(tile.tile, sky_block / 2, sky_block, x, y);
  float seen = 0, all = 0;
  for (int j = window.y0; j < window.y1; ++j)
    for (int i = window.x0; i < window.x1; ++i) {
      const PixelLight& other = tile.at(i, j);
      const bool counts = rays == SkyRays::first ? other.is_first(LightRay::sky) : other.is_cast(LightRay::sky);
      if (!counts || !is_same_surface(own, other)) continue;
      const Vec3<float>& direction = light_direction(lighting, tile.tile.x + i, tile.tile.y + j, LightRay::sky);
      const float by = dot(own.normal, direction);
      if (!(by > min_cosine)) continue;
      seen += by * other.seen[int(LightRay::sky)];
      all += by;
    }
  share = all > 0 ? seen / all : 1;
  return all > 0;
}

/// The max distance, along each axis, of the pixel whose light a pixel without a surface takes.
inline constexpr int max_apart = 2;

/// Returns the light for a pixel without PixelLight::has_surface. This is the light of the nearest pixel that has a
/// surface, or unshadowed light if no pixel nearby has a surface.
GB_HD PixelLight light_beside(const TileLights& tile, const CastLighting& lighting, int x, int y) {
  const LightWindow window = window_around(tile.tile, max_apart, 2 * max_apart + 1, x, y);
  int nearest = INT32_MAX, from_x = 0, from_y = 0;
  for (int j = window.y0; j < window.y1; ++j)
    for (int i = window.x0; i < window.x1; ++i) {
      const int squared = (i - x) * (i - x) + (j - y) * (j - y);
      if (squared >= nearest || !tile.at(i, j).has_surface) continue;
      nearest = squared;
      from_x = i;
      from_y = j;
    }
  if (nearest != INT32_MAX) return tile.at(from_x, from_y);
  PixelLight open;
  open.facing = lighting.light.to_sun[2] > 0 ? lighting.light.to_sun[2] : 0;
  open.seen[int(LightRay::sun)] = 1;
  return open;
}

/// The surface that a pixel shows, and its light.
struct SurfacePoint {
  Vec3d place;         ///< lod-0 voxels of the scene's lattice
  Vec3<float> normal;  ///< unit vector of the side that the eye sees; towards the eye if the voxels have no normals
  float distance;      ///< from the eye
  Vec3<float> own;     ///< own colour: linear RGB, premultiplied by `there`
  float there;         ///< fraction of the pixel that is surface, above 0
  float facing;        ///< mean of max(0, cosine between the sun's direction and the normal)
  float sun_seen;      ///< visible fraction of the sun; 1 if no rays are cast to the light
  float sky_seen;      ///< visible fraction of the sky: 1/2 for an open wall, 1 for open flat ground
};

/// Returns the surface that pixel i of a tile shows. `ray` is the pixel's finished ray and contains the surface's own
/// colour. `tile` holds the finished light of all pixels.
/// Range   ray.transmittance < 1.
GB_HD SurfacePoint surface_point(const CastRay& ray, const Vec3d& eye, const TileLights& tile,
                                 const CastLighting& lighting, std::size_t i) {
  const int x = int(i % std::size_t(tile.tile.width)), y = int(i / std::size_t(tile.tile.width));
  const PixelLight own = tile.at(x, y).has_surface ? tile.at(x, y) : light_beside(tile, lighting, x, y);
  const bool is_cast = lighting.part != CastLightPart::unshadowed;
  float sky = 1;
  if (is_cast) sky_around(tile, lighting, x, y, own, SkyRays::all, sky);
  SurfacePoint at;
  at.place = eye + static_cast<Vec3d>(own.at);
  at.normal = own.normal;
  at.own = ray.rgb;
  at.distance = own.depth;
  at.there = 1 - ray.transmittance;
  at.facing = own.facing;
  at.sun_seen = is_cast ? own.seen[int(LightRay::sun)] : 1;
  at.sky_seen = own.up * sky;
  return at;
}

}  // namespace gigabake::kernels
