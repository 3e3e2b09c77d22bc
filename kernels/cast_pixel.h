/// From a finished ray to a pixel: what is behind it, straight alpha, sRGB.
#pragma once

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

GB_HD void write_pixel(const CastRay& ray, const CastLine& line, const CastBackground& back, const Tables& tables,
                       std::uint8_t out[4]) {
  const float back_alpha = back.has_sky ? 1 : back.alpha;
  const float alpha = 1 - ray.transmittance * (1 - back_alpha);
  for (int k = 0; k < 3; ++k) {
    const float behind = back.has_sky ? sky_channel(back.sky, line.direction[2], k) : back.rgb[k];
    const float premultiplied = ray.rgb[k] + ray.transmittance * behind;
    const float straight = alpha > 0 ? premultiplied / alpha : 0;
    out[k] = tables.srgb_from_linear[std::size_t((straight < 1 ? straight : 1) * 65535 + 0.5f)];
  }
  out[3] = std::uint8_t(alpha * 255 + 0.5f);
}

}  // namespace gigabake::kernels
