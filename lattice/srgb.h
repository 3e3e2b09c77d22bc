/// sRGB and linear light, both from 0 to 1, and as bytes.
///
/// Source  IEC 61966-2-1.
#pragma once

#include <array>
#include <cstdint>

namespace gigabake {

double linear_from_srgb(double srgb);
double srgb_from_linear(double linear);

/// [byte]: linear_from_srgb(byte / 255).
const std::array<double, 256>& linear_of_srgb();
/// The nearest byte, so that linear_of_srgb() and this give a byte back.
std::uint8_t srgb_byte(double linear);

/// Linear light of an sRGB value, 65535 = 1. What is beyond 0 to 1 is clamped, what is not finite is 0.
std::uint16_t linear16(double srgb);

}  // namespace gigabake
