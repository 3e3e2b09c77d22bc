#include <algorithm>
#include <cmath>

#include "sample/settlement/building_kit.h"
#include "sample/terrain/noise.h"

namespace gigabake::sample {
namespace {

constexpr int texels = 512;

/// Computes the colour of a window at (x_m, y_m) from its centre. Returns false outside of the window.
bool window_colour(double x_m, double y_m, Rgb& c) {
  const double ax = std::fabs(x_m), ay = std::fabs(y_m);
  if (ax > 0.72 || ay > 0.86) return false;
  c = {226, 222, 212};  // frame
  if (ax < 0.58 && ay < 0.72 && ax > 0.04 && std::fabs(y_m - 0.1) > 0.04)
    c = mix({52, 64, 78}, {116, 134, 150}, clamp01(0.5 + 0.6 * y_m));
  return true;
}

/// Returns true if a card's texel is foliage. (x, y) is the texel's position on the card, -1 to 1. Sets `light` to the
/// brightness of the texel.
bool is_foliage(std::uint32_t seed, double x, double y, bool needles, double& light) {
  const double r = std::sqrt(x * x + y * y);
  const double wavelength = needles ? 0.10 : 0.22;
  const double blob = noise(seed, x / wavelength, needles ? y / (3 * wavelength) : y / wavelength);
  light = 0.9 + 0.35 * noise(seed + 1, x / 0.07, y / 0.07);
  return blob > 0.55 * smooth_step(0.35, 1.0, r) * 1.4 - 0.16;
}

}  // namespace

Picture paint_facade(std::uint32_t seed) {
  Picture p(texels, texels, 3);
  for (int y = 0; y < texels; ++y)
    for (int x = 0; x < texels; ++x) {
      const double across_m = (x + 0.5) * facade_m / texels, up_m = facade_m - (y + 0.5) * facade_m / texels;
      const double stain = fractal_noise(seed, across_m, up_m * 2, 3);
      Rgb c = scaled({224, 218, 204}, 1 + 0.06 * stain - 0.22 * smooth_step(0.7, 0.0, up_m));
      const double bay = across_m - (std::floor(across_m / 3) * 3 + 1.5);
      if (up_m < 5.6) {
        window_colour(bay, up_m - (up_m < 2.75 ? 1.65 : 4.3), c);
        const bool is_door = across_m > 3 && across_m < 6 && up_m < 2.2 && std::fabs(bay) < 0.55;
        if (is_door) c = scaled({104, 72, 48}, 1 + 0.2 * noise(seed + 2, across_m * 9, up_m));
      } else if (std::fabs(across_m - 6) < 1.5) {
        window_colour((across_m - 6) * 1.2, (up_m - 6.9) * 1.2, c);
      }
      p.set(x, y, c);
    }
  return p;
}

Picture paint_roof(std::uint32_t seed) {
  Picture p(texels, texels, 3);
  for (int y = 0; y < texels; ++y)
    for (int x = 0; x < texels; ++x) {
      const double across_m = (x + 0.5) * roof_width_m / texels, along_m = (y + 0.5) * roof_height_m / texels;
      const auto row = std::int32_t(along_m / 0.34);
      const double shift_m = row % 2 == 0 ? 0 : 0.15, in_row = along_m / 0.34 - row;
      const auto tile = std::int32_t((across_m + shift_m) / 0.30);
      const double own = unit(hash_of(seed, row, tile));
      const double moss = smooth_step(0.1, 0.5, fractal_noise(seed + 1, across_m / 2, along_m / 2, 3));
      Rgb c = scaled({186, 120, 92}, (0.84 + 0.24 * own) * (1 - 0.38 * smooth_step(0.8, 1.0, in_row)));
      p.set(x, y, mix(c, {110, 108, 74}, 0.35 * moss));
    }
  return p;
}

Picture paint_foliage(std::uint32_t seed) {
  constexpr int edge = 128;
  Picture p(2 * edge, edge, 4);
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < 2 * edge; ++x) {
      const bool needles = x >= edge;
      const double u = ((x % edge) + 0.5) / edge * 2 - 1, v = (y + 0.5) / edge * 2 - 1;
      double light = 1;
      const bool there = is_foliage(seed + (needles ? 7 : 0), u, v, needles, light);
      p.set(x, y, scaled(needles ? Rgb{48, 74, 44} : Rgb{82, 112, 46}, light));
      p.at(x, y)[3] = there ? 255 : 0;
    }
  return p;
}

KitImages paint_kit(std::uint32_t seed) {
  return {{"image/jpeg", to_jpeg(paint_facade(seed + 81), jpeg_quality), "textures/facade.jpg"},
          {"image/jpeg", to_jpeg(paint_roof(seed + 82), jpeg_quality), "textures/roof.jpg"},
          {"image/png", to_png(paint_foliage(seed + 80)), "textures/foliage.png"}};
}

}  // namespace gigabake::sample
