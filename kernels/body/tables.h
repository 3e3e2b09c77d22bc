/// Lookup tables of the kernels, built once on the host and borrowed by every backend. No backend therefore evaluates
/// transcendental functions itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/host_device.h"

namespace gigabake::kernels {

/// Numbers of entries of the tables. An entry of Tables::unit_normal has four numbers.
inline constexpr std::size_t srgb_codes = 256, linear_values = 65536, normal_codes = 65536, alpha_sums = 64 * 255 + 1;
inline constexpr std::size_t normal_steps = 128, planar_coverages = 256 * normal_steps;

/// Borrowed pointers to the tables.
struct Tables {
  const std::uint16_t* linear_from_srgb = nullptr;  ///< [256]   sRGB 8-bit to linear, 65535 = 1
  const std::uint8_t* srgb_from_linear = nullptr;   ///< [65536] the nearest sRGB 8-bit code, halves up
  const std::int16_t* unit_normal =
      nullptr;  ///< [65536][4] x, y, z of unit length 32767, indexed by pack_normal(), then 0
  const std::uint8_t* thesis_alpha =
      nullptr;  ///< [16321] 255·a^(1-a), indexed by the sum of 64 8-bit alphas; a is their mean
  const std::uint8_t* planar_coverage = nullptr;  ///< [256][128] 255·(1-(1-a)^n), indexed by 8-bit alpha a, then 127·n
  const std::uint16_t* linear_from_code =
      nullptr;  ///< [256] 257·code, in place of linear_from_srgb for textures that are not colours
};

/// Owner of the tables.
/// Source  IEC 61966-2-1 (sRGB); Cigolle et al. 2014 (octahedral normals); the thesis's opacity rule a^(1-a).
class TableStore {
 public:
  TableStore();
  Tables view() const;
  static const TableStore& host();  ///< built at first use, immutable

 private:
  std::vector<std::uint16_t> linear_from_srgb_;
  std::vector<std::uint8_t> srgb_from_linear_;
  std::vector<std::int16_t> unit_normal_;
  std::vector<std::uint8_t> thesis_alpha_, planar_coverage_;
  std::vector<std::uint16_t> linear_from_code_;
};

}  // namespace gigabake::kernels
