/// Images in linear light: the format of reference images and of image comparisons.
#pragma once

#include <array>
#include <vector>

#include "viewer/pictures/picture.h"

namespace gigabake::bench {

/// An image of premultiplied RGBA, 4 values per pixel; row 0 is the top row.
struct LinearPicture {
  int width = 0, height = 0;
  std::vector<float> rgba;

  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  float alpha(std::size_t pixel) const { return rgba[4 * pixel + 3]; }
};

using Rgb = std::array<double, 3>;

LinearPicture to_linear(const Picture& picture);
/// Returns the image in 8-bit sRGB.
/// Exact   Rounds to the nearest 8-bit code: to_linear() of the result is within half a code.
Picture to_srgb(const LinearPicture& picture);

/// Applies the tone mapping of `gigabake render` to an image of lit surfaces.
LinearPicture on_screen(LinearPicture picture);

/// Returns the linear RGB of each pixel in front of a grey background with the linear value `background`.
std::vector<Rgb> over(const LinearPicture& picture, double background);

/// Returns the sRGB code of a linear value.
/// Range   Values are clamped to 0 … 1.
/// Source  IEC 61966-2-1.
double srgb_code(double linear);

}  // namespace gigabake::bench
