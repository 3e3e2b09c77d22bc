/// Unit vectors in two signed bytes (octahedral encoding), rounded to nearest: the error is at most 0.96°.
/// Source  Cigolle et al. 2014 (JCGT 3(2)).
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/rounding.h"
#include "core/math/vec3.h"

namespace gigabake {

/// Encodes the direction of (x,y,z), which need not have unit length. The zero vector becomes (0,0,1).
/// Exact   IEEE double, no contraction: host and device return the same bits.
GB_HD void encode_octahedral(double x, double y, double z, std::int8_t out[2]) {
  const double l1 = (std::fabs(x) + std::fabs(y)) + std::fabs(z);
  if (!(l1 > 0)) {
    out[0] = out[1] = 0;
    return;
  }
  double px = x / l1, py = y / l1;
  if (z < 0) {
    const double fx = (1 - std::fabs(py)) * (px < 0 ? -1.0 : 1.0);
    py = (1 - std::fabs(px)) * (py < 0 ? -1.0 : 1.0);
    px = fx;
  }
  out[0] = std::int8_t(floor_to_int32(px * 127 + 0.5));
  out[1] = std::int8_t(floor_to_int32(py * 127 + 0.5));
}

/// Decodes a unit vector.
GB_HD void decode_octahedral(const std::int8_t oct[2], double n[3]) {
  double x = oct[0] / 127.0, y = oct[1] / 127.0;
  const double z = (1 - std::fabs(x)) - std::fabs(y);
  if (z < 0) {
    const double fx = (1 - std::fabs(y)) * (x < 0 ? -1.0 : 1.0);
    y = (1 - std::fabs(x)) * (y < 0 ? -1.0 : 1.0);
    x = fx;
  }
  const double length = std::sqrt((x * x + y * y) + z * z);
  n[0] = x / length;
  n[1] = y / length;
  n[2] = z / length;
}

/// Returns the unit vector for a viewer or an export: computed in double, rounded once to float.
inline Vec3<float> unit_normal(const std::int8_t oct[2]) {
  Vec3d n;
  decode_octahedral(oct, n.v);
  return static_cast<Vec3<float>>(n);
}

}  // namespace gigabake
