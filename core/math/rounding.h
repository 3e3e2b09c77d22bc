/// Rounding of a double down to an integer; one instruction on a device.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake {

/// Returns the largest integer that is not above `x`.
/// Range   The result fits.
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

}  // namespace gigabake
