/// Pictures in linear light, as references are drawn and comparisons are made.
#pragma once

#include <array>
#include <vector>

#include "viewer/pictures/picture.h"

namespace gigabake::bench {

/// Premultiplied RGBA, 4 a pixel; row 0 is the upper one.
struct LinearPicture {
  int width = 0, height = 0;
  std::vector<float> rgba;

  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  float alpha(std::size_t pixel) const { return rgba[4 * pixel + 3]; }
};

using Rgb = std::array<double, 3>;

LinearPicture to_linear(const Picture& picture);
/// Exact   The nearest 8-bit codes: to_linear() of it is within half a code.
Picture to_srgb(const LinearPicture& picture);

/// What a screen shows of light, as `render` has it.
LinearPicture on_screen(LinearPicture picture);

/// Linear RGB of each pixel before a grey background of this linear value.
std::vector<Rgb> over(const LinearPicture& picture, double background);

/// Source  IEC 61966-2-1. Range  0 … 1; beyond, the nearest of it.
double srgb_code(double linear);

}  // namespace gigabake::bench
