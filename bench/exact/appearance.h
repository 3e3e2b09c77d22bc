/// The meaning of stored colours and directions, computed from the standards and not from kernels/tables.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>

#include "core/math/vec3.h"

namespace gigabake::reference {

using Direction = Vec3d;
using Rgba16 = std::array<std::uint16_t, 4>;  ///< linear, straight alpha
inline constexpr Rgba16 white16{65535, 65535, 65535, 65535};

/// Converts between sRGB and linear values, both in 0 … 1.
/// Source  IEC 61966-2-1.
inline double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }
inline double srgb_of(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// Returns the distance of a stored sRGB code from the exact linear value, in codes. Rounding causes an error of up to
/// 0.5.
inline double code_error(int code, double linear) { return std::abs(code - 255 * srgb_of(linear)); }

/// Returns the unit vector of an octahedral code.
/// Source  Cigolle et al. 2014.
inline Direction direction_of(const std::array<std::int8_t, 2>& octahedral) {
  const double u = octahedral[0] / 127.0, v = octahedral[1] / 127.0;
  Direction d{u, v, 1 - std::abs(u) - std::abs(v)};
  if (d[2] < 0) {
    d[0] = std::copysign(1 - std::abs(v), u);
    d[1] = std::copysign(1 - std::abs(u), v);
  }
  return d / length(d);
}

inline double angle_deg(const Direction& a, const Direction& b) {
  const double cosine = dot(a, b) / std::sqrt(dot(a, a) * dot(b, b));
  return std::acos(std::min(1.0, std::max(-1.0, cosine))) * 180 / std::numbers::pi;
}

/// The maximum angle between a direction and the direction that its two stored bytes represent (measured in
/// tests/core/octahedral_test.cpp).
inline constexpr double octahedral_error_deg = 0.96;

}  // namespace gigabake::reference
