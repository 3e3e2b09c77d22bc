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
  for (int c = 0; c < 3; ++c) normal[c] = std::int16_t(std::floor(unpermuted(n, t.axis, c) * scale + 0.5));
}

struct Barycentric {
  double a, b, c;
};

/// Barycentric coordinates of p, moved onto the triangle where they lie outside.
GB_HD Barycentric barycentric(const TrianglePlane& t, Point2 p) {
  const double u1 = t.u[1] - t.u[0], v1 = t.v[1] - t.v[0], u2 = t.u[2] - t.u[0], v2 = t.v[2] - t.v[0];
  const double pu = p.u - t.u[0], pv = p.v - t.v[0], inverse = t.inverse_twice_area;
  const double b = clamp01((pu * v2 - u2 * pv) * inverse), c = clamp01((u1 * pv - pu * v1) * inverse);
  const double a = clamp01(1 - b - c);
  const double inverse_sum = 1 / ((a + b) + c);
  return {a * inverse_sum, b * inverse_sum, c * inverse_sum};
}

/// Whether the fragment is large enough for moment over area to be its centroid.
GB_HD bool has_centroid(double projected_area) { return std::fabs(projected_area) >= smallest_centroid_area; }

GB_HD Point2 centroid_of(const CellMoments& m, double cell_u, double cell_v) {
  const double inverse = 1 / m.area;
  return {cell_u + clamp01(m.u * inverse), cell_v + clamp01(m.v * inverse)};
}

/// Where a fragment is shaded: its centroid, or for the thinnest of them the triangle's point at the cell's centre.
GB_HD Point2 fragment_centroid(const TrianglePlane& t, const CellMoments& m, double cell_u, double cell_v) {
  if (has_centroid(m.area)) return centroid_of(m, cell_u, cell_v);
  const Barycentric w = barycentric(t, {cell_u + 0.5, cell_v + 0.5});
  return {w.a * t.u[0] + w.b * t.u[1] + w.c * t.u[2], w.a * t.v[0] + w.b * t.v[1] + w.c * t.v[2]};
}

/// A channel's mean of the three vertices: the whole number that is nearest.
GB_HD double vertex_mean(const Surface& s, int channel, const Barycentric& w) {
  return std::floor(w.a * s.vertex_rgba[0][channel] + w.b * s.vertex_rgba[1][channel] +
                    w.c * s.vertex_rgba[2][channel] + 0.5);
}

/// Straight linear RGBA of base colour and, where there are any, vertex colours' mean.
GB_HD Rgba16 factor_of(const Surface& s, const double mean[4]) {
  Rgba16 r;
  for (int c = 0; c < 4; ++c)
    r.c[c] = s.has_vertex_rgba ? scale16(s.material.base_rgba[c], std::uint32_t(mean[c])) : s.material.base_rgba[c];
  return r;
}

/// Premultiplied linear RGBA of a fragment without texture.
GB_HD Rgba16 shade_untextured(const Surface& s, const double mean[4]) {
  Rgba16 factor = factor_of(s, mean);
  if (s.material.alpha_mode != AlphaMode::opaque)
    return apply_material(s.material, factor, Rgba16{{65535, 65535, 65535, 65535}});
  factor.c[3] = 65535;
  return factor;
}

/// Premultiplied linear RGBA of the fragment around `centroid`; projected_area in voxel².
GB_HD Rgba16 shade(const Surface& s, const TrianglePlane& t, Point2 centroid, double projected_area,
                   const Tables& tables) {
  double mean[4] = {65535, 65535, 65535, 65535};
  if (s.has_vertex_rgba) {
    const Barycentric w = barycentric(t, centroid);
    for (int c = 0; c < 4; ++c) mean[c] = vertex_mean(s, c, w);
  }
  if (s.texture == nullptr) return shade_untextured(s, mean);
  const Rgba16 texel =
      texture_over(*s.texture, s.material, s.map, centroid.u, centroid.v, std::fabs(projected_area), tables);
  return apply_material(s.material, factor_of(s, mean), texel);
}

GB_HD Fragment make_fragment(const Surface& s, const Rgba16& rgba, std::int64_t weight) {
  Fragment f;
  f.weight = weight;
  for (int c = 0; c < 4; ++c) f.rgba[c] = rgba.c[c];
  for (int c = 0; c < 3; ++c) f.normal[c] = s.normal[c];
  return f;
}

}  // namespace gigabake::kernels
