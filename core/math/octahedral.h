/// Unit vectors in two signed integers (octahedral encoding), rounded to nearest. The error is at most 0.96° in bytes.
/// Source  Cigolle et al. 2014 (JCGT 3(2)).
#pragma once

#include <array>
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

/// Direction of a vertex normal in two signed 16-bit integers, or no_vertex_normal. The error is at most 0.004°.
using VertexNormal = std::array<std::int16_t, 2>;

/// Largest value of a component; 1 in the octahedron |x| + |y| + |z| = 1.
inline constexpr std::int32_t vertex_normal_unit = 32767;
/// First component of the code of a vertex without a normal. No direction has it.
inline constexpr std::int16_t no_vertex_normal = -32768;

/// Returns the code of a direction of any length. Returns no_vertex_normal if the length is zero or not finite.
inline VertexNormal encode_vertex_normal(const Vec3d& n) {
  const double sum = (std::fabs(n[0]) + std::fabs(n[1])) + std::fabs(n[2]);
  if (!(sum > 0 && std::isfinite(sum))) return {no_vertex_normal, no_vertex_normal};
  double x = n[0] / sum, y = n[1] / sum;
  if (n[2] < 0) {
    const double folded = (1 - std::fabs(y)) * (x < 0 ? -1.0 : 1.0);
    y = (1 - std::fabs(x)) * (y < 0 ? -1.0 : 1.0);
    x = folded;
  }
  return {std::int16_t(std::floor(x * vertex_normal_unit + 0.5)),
          std::int16_t(std::floor(y * vertex_normal_unit + 0.5))};
}

/// Returns a vector in the direction of a code, with |x| + |y| + |z| = vertex_normal_unit.
/// Range   code[0] is not no_vertex_normal.
/// Exact   Integers: host and device return the same bits.
GB_HD Vec3d decode_vertex_normal(const std::int16_t code[2]) {
  const std::int32_t one = 32767, u = code[0], v = code[1], along = u < 0 ? -u : u, across = v < 0 ? -v : v;
  const std::int32_t z = one - along - across;
  const std::int32_t x = z < 0 ? (u < 0 ? across - one : one - across) : u;
  const std::int32_t y = z < 0 ? (v < 0 ? along - one : one - along) : v;
  return {double(x), double(y), double(z)};
}

/// Direction of a vertex tangent like a VertexNormal. The lowest bit of the second component is set if the bitangent is
/// normal × tangent times -1, as where texture coordinates are mirrored. The error is at most 0.008°.
using VertexTangent = std::array<std::int16_t, 2>;

/// Returns the code of a tangent of any length. Returns no_vertex_normal if the length is zero or not finite.
inline VertexTangent encode_vertex_tangent(const Vec3d& t, bool is_mirrored) {
  VertexTangent code = encode_vertex_normal(t);
  if (code[0] != no_vertex_normal) code[1] = std::int16_t((code[1] & ~1) | (is_mirrored ? 1 : 0));
  return code;
}

/// Returns true if the bitangent of the code is normal × tangent times -1. decode_vertex_normal() returns the tangent.
GB_HD bool has_mirrored_bitangent(const std::int16_t code[2]) { return (code[1] & 1) != 0; }

}  // namespace gigabake
