/// Colour spaces in which perceived differences are measured, relative to the white of sRGB (D65).
#pragma once

#include <array>
#include <cmath>

#include "bench/accuracy/linear_picture.h"

namespace gigabake::bench {

/// Returns X, Y and Z of a linear sRGB colour, each divided by the same coordinate of white.
/// Source  IEC 61966-2-1.
inline std::array<double, 3> relative_xyz(const Rgb& c) {
  return {(0.4124564 * c[0] + 0.3575761 * c[1] + 0.1804375 * c[2]) / 0.9504700,
          0.2126729 * c[0] + 0.7151522 * c[1] + 0.0721750 * c[2],
          (0.0193339 * c[0] + 0.1191920 * c[1] + 0.9503041 * c[2]) / 1.0888300};
}

/// Returns the linear sRGB of relative_xyz().
inline Rgb linear_rgb(const std::array<double, 3>& relative) {
  const double x = relative[0] * 0.9504700, y = relative[1], z = relative[2] * 1.0888300;
  return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
          0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

/// Returns L* from 0 to 100, a*, b*.
/// Source  CIE 15:2004.
inline std::array<double, 3> cie_lab(const Rgb& c) {
  const auto f = [](double t) {
    constexpr double d = 6.0 / 29;
    return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
  };
  const std::array<double, 3> p = relative_xyz(c);
  return {116 * f(p[1]) - 16, 500 * (f(p[0]) - f(p[1])), 200 * (f(p[1]) - f(p[2]))};
}

}  // namespace gigabake::bench
