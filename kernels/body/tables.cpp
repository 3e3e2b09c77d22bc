#include "kernels/body/tables.h"

#include <algorithm>
#include <cmath>

#include "core/math/octahedral.h"
#include "core/math/srgb.h"

namespace gigabake::kernels {
namespace {

std::vector<std::uint16_t> make_linear_from_srgb() {
  std::vector<std::uint16_t> table(srgb_codes);
  for (int s = 0; s < 256; ++s) table[s] = std::uint16_t(std::floor(linear_from_srgb(s / 255.0) * 65535 + 0.5));
  return table;
}

/// Returns the nearest sRGB code for each linear value. The values of code c begin at the linear value of c - 1/2.
std::vector<std::uint8_t> make_srgb_from_linear() {
  std::vector<std::uint8_t> table(linear_values);
  int code = 0;
  for (int l = 0; l < 65536; ++l) {
    while (code < 255 && l >= linear_from_srgb((code + 0.5) / 255.0) * 65535) ++code;
    table[l] = std::uint8_t(code);
  }
  return table;
}

std::vector<std::int16_t> make_unit_normal() {
  std::vector<std::int16_t> table(4 * normal_codes, 0);
  for (int i = 0; i < 65536; ++i) {
    const std::int8_t oct[2] = {std::int8_t(std::max(-127, int(std::int8_t(i & 255)))),
                                std::int8_t(std::max(-127, int(std::int8_t(i >> 8))))};
    double n[3];
    decode_octahedral(oct, n);
    for (int c = 0; c < 3; ++c) table[4 * i + c] = std::int16_t(std::floor(n[c] * 32767 + 0.5));
  }
  return table;
}

std::vector<std::uint8_t> make_thesis_alpha() {
  std::vector<std::uint8_t> table(alpha_sums, 0);
  for (int sum = 1; sum <= 64 * 255; ++sum) {
    const double a = sum / (64 * 255.0);
    table[sum] = std::uint8_t(std::floor(255 * std::pow(a, 1 - a) + 0.5));
  }
  return table;
}

std::vector<std::uint8_t> make_planar_coverage() {
  std::vector<std::uint8_t> table;
  for (int alpha = 0; alpha < 256; ++alpha)
    for (int n = 0; n < int(normal_steps); ++n)
      table.push_back(std::uint8_t(std::floor(255 * (1 - std::pow(1 - alpha / 255.0, n / 127.0)) + 0.5)));
  return table;
}

std::vector<std::uint16_t> make_linear_from_code() {
  std::vector<std::uint16_t> table(srgb_codes);
  for (std::size_t code = 0; code < srgb_codes; ++code) table[code] = std::uint16_t(257 * code);
  return table;
}

}  // namespace

TableStore::TableStore()
    : linear_from_srgb_(make_linear_from_srgb()),
      srgb_from_linear_(make_srgb_from_linear()),
      unit_normal_(make_unit_normal()),
      thesis_alpha_(make_thesis_alpha()),
      planar_coverage_(make_planar_coverage()),
      linear_from_code_(make_linear_from_code()) {}

Tables TableStore::view() const {
  return {linear_from_srgb_.data(), srgb_from_linear_.data(), unit_normal_.data(),
          thesis_alpha_.data(),     planar_coverage_.data(),  linear_from_code_.data()};
}

const TableStore& TableStore::host() {
  static const TableStore store;
  return store;
}

}  // namespace gigabake::kernels
