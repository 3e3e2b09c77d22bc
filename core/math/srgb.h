/// Conversions between sRGB and linear light, both in 0 to 1 and as bytes.
///
/// Source  IEC 61966-2-1.
#pragma once

#include <array>
#include <cstdint>

namespace gigabake {

double linear_from_srgb(double srgb);
double srgb_from_linear(double linear);

/// Returns a table of linear_from_srgb(byte / 255), indexed by the byte.
const std::array<double, 256>& linear_of_srgb();
/// Returns the nearest sRGB byte; the inverse of linear_of_srgb().
std::uint8_t srgb_byte(double linear);

/// Returns the linear light of an sRGB value in units of 1/65535. Clamps `srgb` to 0 to 1; NaN and infinity become 0.
std::uint16_t linear16(double srgb);

}  // namespace gigabake
