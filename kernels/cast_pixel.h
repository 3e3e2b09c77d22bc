/// From a finished ray to a pixel: what is behind it, in linear light; and as straight alpha, sRGB.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/cast.h"
#include "kernels/tables.h"

namespace gigabake::kernels {

/// Linear RGB of a sky: towards the horizon, straight up, straight down.
struct CastSky {
  float horizon[3] = {0, 0, 0}, zenith[3] = {0, 0, 0}, nadir[3] = {0, 0, 0};
};

/// What shows where no voxel does: a sky, or one premultiplied linear colour.
struct CastBackground {
  bool has_sky = false;
  CastSky sky;
  float rgb[3] = {0, 0, 0};
  float alpha = 0;
};

/// In a direction (unit, z up); below the horizon a haze that darkens downwards.
GB_HD float sky_channel(const CastSky& sky, double up, int channel) {
  const float h = sky.horizon[channel];
  if (up >= 0) return h + (sky.zenith[channel] - h) * float(1 - (1 - up) * (1 - up));
  return h + (sky.nadir[channel] - h) * float(-up);
}

/// What reaches the eye: linear, premultiplied; brighter than 1 where it is.
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

GB_HD void write_srgb(const CastLinear& pixel, const Tables& tables, std::uint8_t out[4]) {
  const float alpha = pixel.rgba[3];
  for (int k = 0; k < 3; ++k) {
    const float straight = alpha > 0 ? pixel.rgba[k] / alpha : 0;
    out[k] = tables.srgb_from_linear[std::size_t((straight < 1 ? straight : 1) * 65535 + 0.5f)];
  }
  out[3] = std::uint8_t(alpha * 255 + 0.5f);
}

/// Where the pixels of a tile go, its rows one after the other; null: not asked for.
struct CastPixels {
  std::uint8_t* srgb = nullptr;  ///< four a pixel, straight alpha
  float* linear = nullptr;       ///< four a pixel, CastLinear
  float* depth = nullptr;        ///< voxels; CastRay::no_depth where half of the light comes through
};

/// Pixel i of the tile.
GB_HD void write_pixel(const CastRay& ray, const CastLine& line, const CastBackground& back, const Tables& tables,
                       std::size_t i, const CastPixels& out) {
  const CastLinear pixel = linear_pixel(ray, line, back);
  if (out.srgb != nullptr) write_srgb(pixel, tables, out.srgb + 4 * i);
  for (std::size_t k = 0; out.linear != nullptr && k < 4; ++k) out.linear[4 * i + k] = pixel.rgba[k];
  if (out.depth != nullptr) out.depth[i] = ray.depth;
}

}  // namespace gigabake::kernels
