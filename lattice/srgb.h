/// sRGB bytes and linear light.
#pragma once

#include <array>
#include <cstdint>

namespace gigabake {

/// Source  IEC 61966-2-1. linear_of_srgb()[byte] is from 0 to 1; srgb_byte rounds, so it gives the byte back.
const std::array<double, 256>& linear_of_srgb();
std::uint8_t srgb_byte(double linear);

/// Linear light of an sRGB value from 0 to 1, 65535 = 1. What is beyond is clamped, what is not finite is 0.
std::uint16_t linear16(double srgb);

}  // namespace gigabake
