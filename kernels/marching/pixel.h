/// Conversion of a finished ray to a pixel: linear light including the background, and sRGB with straight alpha for a
/// screen.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/body/tables.h"
#include "kernels/marching/cast_camera.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/cast_ray.h"

namespace gigabake::kernels {

/// Returns a channel of the sky for the z component `up` of a unit direction. Below the horizon the sky is a haze that
/// becomes the nadir's colour downwards.
GB_HD float sky_channel(const CastSky& sky, double up, int channel) {
  const float h = sky.horizon[channel];
  if (up >= 0) return h + (sky.zenith[channel] - h) * float(1 - (1 - up) * (1 - up));
  return h + (sky.nadir[channel] - h) * float(-up);
}

/// The light that reaches the eye: linear, premultiplied, not limited to 1.
struct CastLinear {
  float rgba[4];
};

GB_HD CastLinear linear_pixel(const CastRay& ray, const CastLine& line, const CastBackground& back) {
  CastLinear out;
  for (int k = 0; k < 3; ++k) {
    const float behind = back.has_sky ? sky_channel(back.sky, line.direction[2], k) : back.rgb[k];
    out.rgba[k] = ray.rgb[k] + ray.transmittance * behind;
  }
  out.rgba[3] = 1 - ray.transmittance * (1 - (back.has_sky ? 1 : back.alpha));
  return out;
}

/// Returns the displayed value of a channel, not premultiplied by alpha. The tone curve applies to a sky as it does to
/// surfaces, but not to a background colour.
GB_HD float shown_channel(const CastRay& ray, const CastLinear& light, const CastTone& tone, const CastBackground& back,
                          int channel) {
  if (back.has_sky) return shown_light(tone, light.rgba[channel]);
  const float surface = 1 - ray.transmittance, straight = surface > 0 ? ray.rgb[channel] / surface : 0;
  const float gain = straight > 0 ? shown_light(tone, straight) / straight : 1;
  const float shown = ray.rgb[channel] * gain + ray.transmittance * back.rgb[channel];
  return light.rgba[3] > 0 ? shown / light.rgba[3] : 0;
}

/// Returns the 8-bit sRGB code just below or just above the linear value, depending on the dither rank. The mean over
/// all 64 ranks reproduces the value between the two codes.
GB_HD std::uint8_t dithered_srgb(const Tables& tables, std::uint32_t linear, std::uint32_t rank) {
  std::uint32_t low = tables.srgb_from_linear[linear];
  if (tables.linear_from_srgb[low] > linear) --low;
  if (low == 255) return 255;
  const std::uint32_t from = tables.linear_from_srgb[low], to = tables.linear_from_srgb[low + 1];
  return std::uint8_t(low + ((linear - from) * 128 > (to - from) * (2 * rank + 1) ? 1 : 0));
}

/// Writes a pixel's sRGB value. Pixels that show the sky are dithered, because a sky's gradient spans fewer codes than
/// pixels; surfaces are rounded.
GB_HD void write_srgb(const CastRay& ray, const CastLinear& light, const CastTone& tone, const CastBackground& back,
                      const Tables& tables, std::uint32_t rank, std::uint8_t out[4]) {
  const bool shows_sky = back.has_sky && ray.transmittance > 0;
  for (int k = 0; k < 3; ++k) {
    const float shown = shown_channel(ray, light, tone, back, k);
    const auto linear = std::uint32_t((shown < 1 ? shown : 1) * 65535 + 0.5f);
    out[k] = shows_sky ? dithered_srgb(tables, linear, rank) : tables.srgb_from_linear[linear];
  }
  out[3] = std::uint8_t(light.rgba[3] * 255 + 0.5f);
}

/// Returns a pixel's finished ray, composited over the polygon behind the voxels that this ray hit.
GB_HD CastRay before_polygons(const CastRay& ray, const CastCamera& camera, int x, int y) {
  CastRay out = ray;
  if (camera.polygons.distance == nullptr) return out;
  const std::size_t i = std::size_t(y) * std::size_t(camera.width) + std::size_t(x);
  const float distance = camera.polygons.distance[i];
  if (!(distance < CastPolygons::nowhere)) return out;
  for (int k = 0; k < 3; ++k) out.rgb[k] += ray.transmittance * camera.polygons.rgba[4 * i + std::size_t(k)];
  out.transmittance *= 1 - camera.polygons.rgba[4 * i + 3];
  if (out.depth == CastRay::no_depth && out.transmittance < 0.5f) out.depth = distance;
  return out;
}

/// Writes pixel i of the tile.
GB_HD void write_pixel(const CastRay& ray, const CastLine& line, const CastTone& tone, const CastTile& tile,
                       const CastBackground& back, const Tables& tables, std::size_t i, const CastPixels& out) {
  const CastLinear light = linear_pixel(ray, line, back);
  const auto width = std::size_t(tile.width);
  const std::uint32_t rank =
      dither_rank(std::uint32_t(tile.x) + std::uint32_t(i % width), std::uint32_t(tile.y) + std::uint32_t(i / width));
  if (out.srgb != nullptr) write_srgb(ray, light, tone, back, tables, rank, out.srgb + 4 * i);
  for (std::size_t k = 0; out.linear != nullptr && k < 4; ++k) out.linear[4 * i + k] = light.rgba[k];
  if (out.depth != nullptr) out.depth[i] = ray.depth;
}

}  // namespace gigabake::kernels
