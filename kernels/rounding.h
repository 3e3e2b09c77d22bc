/// Small steps from doubles to whole numbers and into ranges, as few instructions as host and device need.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/types.h"

namespace gigabake::kernels {

/// Range  the result fits.
GB_HD std::int32_t floor_to_int32(double x) {
#if defined(__CUDA_ARCH__)
  return __double2int_rd(x);
#else
  return std::int32_t(std::floor(x));
#endif
}

GB_HD std::int64_t floor_to_int64(double x) {
#if defined(__CUDA_ARCH__)
  return __double2ll_rd(x);
#else
  return std::int64_t(std::floor(x));
#endif
}

/// x moved into [0, 1]. Range  finite. Zero may lose its sign.
GB_HD double clamp_unit(double x) {
#if defined(__CUDA_ARCH__)  // by the order of bits: comparing and picking doubles takes longer
  constexpr int one = 0x3ff00000;
  const int high = __double2hiint(x);
  return __hiloint2double(min(max(high, 0), one), unsigned(high) < unsigned(one) ? __double2loint(x) : 0);
#else
  return x < 0 ? 0 : (x > 1 ? 1 : x);
#endif
}

}  // namespace gigabake::kernels
