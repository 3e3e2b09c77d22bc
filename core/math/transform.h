/// Affine maps from the matrices and rotations of glTF and 3D Tiles, all in double.
#pragma once

#include <array>
#include <span>

#include "core/math/frames.h"

namespace gigabake {

/// Converts 16 numbers in column order, the format of glTF node.matrix and 3D Tiles transform. Assumes that the fourth
/// row is 0 0 0 1.
template <class To, class From>
Affine<To, From> affine_from_columns(std::span<const double> m) {
  Affine<To, From> r;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) r.m[row][column] = m[4 * column + row];
  return r;
}

template <class To, class From>
Affine<To, From> translation(double x, double y, double z) {
  Affine<To, From> r;
  r.m[0][3] = x;
  r.m[1][3] = y;
  r.m[2][3] = z;
  return r;
}

/// Returns translation · rotation · scale. `q` is a quaternion x, y, z, w of any length; the zero quaternion means no
/// rotation.
template <class To, class From>
Affine<To, From> affine_from_trs(const std::array<double, 3>& t, const std::array<double, 4>& q,
                                 const std::array<double, 3>& s) {
  const double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const double k = n > 0 ? 2 / n : 0;
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  Affine<To, From> r;
  r.m = {{{(1 - k * (y * y + z * z)) * s[0], k * (x * y - w * z) * s[1], k * (x * z + w * y) * s[2], t[0]},
          {k * (x * y + w * z) * s[0], (1 - k * (x * x + z * z)) * s[1], k * (y * z - w * x) * s[2], t[1]},
          {k * (x * z - w * y) * s[0], k * (y * z + w * x) * s[1], (1 - k * (x * x + y * y)) * s[2], t[2]}}};
  return r;
}

/// Returns the quarter turn from `up` to z: about x for y up, about y for x up (like CesiumJS Axis.X_UP_TO_Z_UP).
template <class To, class From>
Affine<To, From> z_up_from(UpAxis up) {
  Affine<To, From> r;
  if (up == UpAxis::y) r.m = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
  if (up == UpAxis::x) r.m = {{{0, 0, -1, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}}};
  return r;
}

}  // namespace gigabake
