#include "lattice/srgb.h"

#include <algorithm>
#include <cmath>

namespace gigabake {

const std::array<double, 256>& linear_of_srgb() {
  static const std::array<double, 256> linear = [] {
    std::array<double, 256> table{};
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const double s = double(byte) / 255;
      table[byte] = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    }
    return table;
  }();
  return linear;
}

std::uint8_t srgb_byte(double linear) {
  const double s = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return std::uint8_t(std::clamp(s, 0.0, 1.0) * 255 + 0.5);
}

std::uint16_t linear16(double srgb) {
  const double v = std::isfinite(srgb) ? std::clamp(srgb, 0.0, 1.0) : 0.0;
  return std::uint16_t(std::lround((v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4)) * 65535));
}

}  // namespace gigabake
