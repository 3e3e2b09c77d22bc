/// A triangle's colour, alpha and normal on one of its fragments.
///
/// Space   (u, v) in voxels from the triangle's anchor, as kernels/coverage.h.
/// Exact   IEEE double and integers: host and device return the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/accumulate.h"
#include "kernels/coverage.h"
#include "kernels/shade.h"

namespace gigabake::kernels {

/// Smallest projected area (voxel²) whose centroid is computed as moment over area; below, rounding would decide.
inline constexpr double smallest_centroid_area = 1e-9;
/// Texture coordinates beyond this (or NaN/Inf) name no texel; the triangle is baked as if they were 0 and counted.
inline constexpr double largest_uv = 1 << 20;

struct Point2 {
  double u, v;
};

/// What shading needs of one triangle; borrowed views stay valid while it is used.
struct Surface {
  MaterialView material;
  const TextureView* texture = nullptr;
  TextureMap map{};
  std::uint16_t vertex_rgba[3][4] = {};
  bool has_vertex_rgba = false;
  std::int16_t normal[3] = {};

  /// False: the same colour everywhere; no fragment needs its centroid.
  GB_HD bool varies() const { return texture != nullptr || has_vertex_rgba; }
};

GB_HD bool usable_uv(const float uv[6]) {
  for (int i = 0; i < 6; ++i)
    if (!(uv[i] >= -largest_uv && uv[i] <= largest_uv)) return false;
  return true;
}

/// Unit normal (32767) by the winding, in scene axes.
template <class I>
GB_HD void geometric_normal(const BrickTriangle<I>& t, std::int16_t normal[3]) {
  const double n[3] = {double(t.n[0]), double(t.n[1]), double(t.n[2])};
  const double scale = 32767 / std::sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
  for (int c = 0; c < 3; ++c) normal[(t.axis + 1 + c) % 3] = std::int16_t(std::floor(n[c] * scale + 0.5));
}

/// Barycentric coordinates of (u, v), moved onto the triangle where they lie outside.
GB_HD void barycentric(const TrianglePlane& t, Point2 p, double b[3]) {
  const double u1 = t.u[1] - t.u[0], v1 = t.v[1] - t.v[0], u2 = t.u[2] - t.u[0], v2 = t.v[2] - t.v[0];
  const double pu = p.u - t.u[0], pv = p.v - t.v[0], inverse = t.inverse_twice_area;
  b[1] = clamp01((pu * v2 - u2 * pv) * inverse);
  b[2] = clamp01((u1 * pv - pu * v1) * inverse);
  b[0] = clamp01(1 - b[1] - b[2]);
  const double inverse_sum = 1 / ((b[0] + b[1]) + b[2]);
  for (int i = 0; i < 3; ++i) b[i] *= inverse_sum;
}

/// Where a fragment is shaded: its centroid, or for the thinnest of them the triangle's point at the cell's centre.
GB_HD Point2 fragment_centroid(const TrianglePlane& t, const CellMoments& m, double cell_u, double cell_v) {
  if (std::fabs(m.area) >= smallest_centroid_area) {
    const double inverse = 1 / m.area;
    return {cell_u + clamp01(m.u * inverse), cell_v + clamp01(m.v * inverse)};
  }
  double b[3];
  barycentric(t, {cell_u + 0.5, cell_v + 0.5}, b);
  return {b[0] * t.u[0] + b[1] * t.u[1] + b[2] * t.u[2], b[0] * t.v[0] + b[1] * t.v[1] + b[2] * t.v[2]};
}

/// Straight linear RGBA of base colour and vertex colours.
GB_HD Rgba16 factor_at(const Surface& s, const TrianglePlane& t, Point2 p) {
  Rgba16 r;
  if (!s.has_vertex_rgba) {
    for (int c = 0; c < 4; ++c) r.c[c] = s.material.base_rgba[c];
    return r;
  }
  double b[3];
  barycentric(t, p, b);
  for (int c = 0; c < 4; ++c) {
    const double mean = b[0] * s.vertex_rgba[0][c] + b[1] * s.vertex_rgba[1][c] + b[2] * s.vertex_rgba[2][c];
    r.c[c] = scale16(s.material.base_rgba[c], std::uint32_t(std::floor(mean + 0.5)));
  }
  return r;
}

/// Premultiplied linear RGBA of the fragment around `centroid`; projected_area in voxel².
GB_HD Rgba16 shade(const Surface& s, const TrianglePlane& t, Point2 centroid, double projected_area,
                   const Tables& tables) {
  Rgba16 texel{{65535, 65535, 65535, 65535}};
  if (s.texture != nullptr)
    texel = texture_over(*s.texture, s.material, s.map, centroid.u, centroid.v, std::fabs(projected_area), tables);
  return apply_material(s.material, factor_at(s, t, centroid), texel);
}

GB_HD Fragment make_fragment(const Surface& s, const Rgba16& rgba, std::int64_t weight) {
  Fragment f;
  f.weight = weight;
  for (int c = 0; c < 4; ++c) f.rgba[c] = rgba.c[c];
  for (int c = 0; c < 3; ++c) f.normal[c] = s.normal[c];
  return f;
}

}  // namespace gigabake::kernels
