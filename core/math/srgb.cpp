#include "core/math/srgb.h"

#include <algorithm>
#include <cmath>

namespace gigabake {

double linear_from_srgb(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

const std::array<double, 256>& linear_of_srgb() {
  static const std::array<double, 256> linear = [] {
    std::array<double, 256> table{};
    for (std::size_t byte = 0; byte < 256; ++byte) table[byte] = linear_from_srgb(double(byte) / 255);
    return table;
  }();
  return linear;
}

std::uint8_t srgb_byte(double linear) {
  return std::uint8_t(std::clamp(srgb_from_linear(linear), 0.0, 1.0) * 255 + 0.5);
}

std::uint16_t linear16(double srgb) {
  const double v = std::isfinite(srgb) ? std::clamp(srgb, 0.0, 1.0) : 0.0;
  return std::uint16_t(std::lround(linear_from_srgb(v) * 65535));
}

}  // namespace gigabake
