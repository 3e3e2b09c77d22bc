/// Colour, alpha and normal of a triangle over one of its fragments.
///
/// Space   (u, v) in voxels from the triangle's anchor, as in kernels/body/voxelize/coverage.h.
/// Exact   IEEE double and integers: host and device return the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/rules.h"
#include "core/math/vec3.h"
#include "kernels/body/texture/nearest_texture.h"
#include "kernels/body/texture/shade.h"
#include "kernels/body/voxelize/accumulate.h"
#include "kernels/body/voxelize/coverage.h"

namespace gigabake::kernels {

/// Max texture coordinate. A triangle with coordinates beyond it (or NaN/Inf) is baked with (0, 0) and counted in
/// CellStats::bad_uv.
inline constexpr double max_uv = 1 << 20;

/// Variation of a triangle's colour over its fragments.
enum class ShadingRate : std::uint8_t {
  flat,     ///< uniform: no fragment needs its moments
  linear,   ///< opaque with vertex colours: LinearColour describes it completely
  varying,  ///< each fragment is shaded separately
};

/// Shading parameters of one triangle. The caller keeps the borrowed views valid while the surface is used.
struct Surface {
  MaterialView material;
  const TextureView* texture = nullptr;
  TextureMap map{};
  std::uint16_t vertex_rgba[3][4] = {};
  bool has_vertex_rgba = false;

  GB_HD bool is_opaque() const { return material.alpha_mode == AlphaMode::opaque; }
  GB_HD ShadingRate look() const {
    if (texture == nullptr && !has_vertex_rgba) return ShadingRate::flat;
    return texture == nullptr && is_opaque() ? ShadingRate::linear : ShadingRate::varying;
  }
};

GB_HD bool usable_uv(const float uv[6]) {
  for (int i = 0; i < 6; ++i)
    if (!(uv[i] >= -max_uv && uv[i] <= max_uv)) return false;
  return true;
}

/// Returns n, scaled to unit length, which is 32767.
GB_HD Vec3<std::int16_t> scale_to_unit(const Vec3d& n) {
  const double scale = 32767 / std::sqrt(dot(n, n));
  return Vec3<std::int16_t>::by_axis([&](int c) { return std::int16_t(floor_to_int32(n[c] * scale + 0.5)); });
}

/// Returns the unit normal of a snapped triangle in scene axes; its sign follows the winding.
template <class I, class N>
GB_HD Vec3<std::int16_t> snapped_normal(const BrickTriangle<I, N>& t) {
  return unpermuted(scale_to_unit(static_cast<Vec3d>(t.n)), t.axis);
}

struct Barycentric {
  double a, b, c;
};

/// Returns the barycentric coordinates of p. Points outside the triangle are moved onto it.
GB_HD Barycentric barycentric(const TrianglePlane& t, Point2 p) {
  const double u1 = t.u[1] - t.u[0], v1 = t.v[1] - t.v[0], u2 = t.u[2] - t.u[0], v2 = t.v[2] - t.v[0];
  const double pu = p.u - t.u[0], pv = p.v - t.v[0], inverse = t.inverse_twice_area;
  const double b = clamp01((pu * v2 - u2 * pv) * inverse), c = clamp01((u1 * pv - pu * v1) * inverse);
  const double a = clamp01(1 - b - c);
  const double inverse_sum = 1 / ((a + b) + c);
  return {a * inverse_sum, b * inverse_sum, c * inverse_sum};
}

/// Returns the point at which a fragment below min_centroid_area is shaded: the cell's centre, moved onto the triangle.
GB_HD Point2 small_centroid(const TrianglePlane& t, double cell_u, double cell_v) {
  const Barycentric w = barycentric(t, {cell_u + 0.5, cell_v + 0.5});
  return {w.a * t.u[0] + w.b * t.u[1] + w.c * t.u[2], w.a * t.v[0] + w.b * t.v[1] + w.c * t.v[2]};
}

/// Sets the variances of a fragment, clamped to the range possible in a unit cell, because rounding may exceed it.
GB_HD void set_variances(const CellMoments& m, float inverse_area, FragmentShape& f) {
  constexpr float maximum = 0.25f;
  const auto u = float(f.centroid.u - f.cell_u), v = float(f.centroid.v - f.cell_v);
  const float twelfth = inverse_area * (1.0f / 12);
  f.uu = larger(0.0f, smaller(m.uu * twelfth - u * u, maximum));
  f.vv = larger(0.0f, smaller(m.vv * twelfth - v * v, maximum));
  f.uv = larger(-maximum, smaller(0.5f * m.uv * twelfth - u * v, maximum));
}

/// Returns the centroid of a fragment. `m` includes first moments.
GB_HD Point2 fragment_centroid(const TrianglePlane& t, const CellMoments& m, double cell_u, double cell_v) {
  if (!has_centroid(m.area)) return small_centroid(t, cell_u, cell_v);
  const double inverse = 1 / m.area;
  return {cell_u + clamp01(m.u * inverse), cell_v + clamp01(m.v * inverse)};
}

/// Returns the shape of a fragment. `m` includes second moments. `polygon_u` and `polygon_v` are the corners of the
/// slab polygon that contains the fragment.
GB_HD FragmentShape fragment_shape(const TrianglePlane& t, const CellMoments& m, double cell_u, double cell_v,
                                   const double* polygon_u, const double* polygon_v, int corners) {
  FragmentShape r{{0, 0}, m.area, 0, 0, 0, cell_u, cell_v, polygon_u, polygon_v, corners};
  r.centroid = fragment_centroid(t, m, cell_u, cell_v);
  if (has_centroid(m.area)) set_variances(m, float(1 / m.area), r);
  return r;
}

/// Returns a colour channel interpolated between the three vertices, rounded to the nearest integer.
GB_HD double vertex_mean(const Surface& s, int channel, const Barycentric& w) {
  return std::floor(w.a * s.vertex_rgba[0][channel] + w.b * s.vertex_rgba[1][channel] +
                    w.c * s.vertex_rgba[2][channel] + 0.5);
}

/// Returns straight linear RGBA: base colour times the mean of the vertex colours, if there are any.
GB_HD Rgba16 factor_of(const Surface& s, const double mean[4]) {
  Rgba16 r = base_factor(s.material);
  for (int c = 0; s.has_vertex_rgba && c < 4; ++c) r.c[c] = scale16(r.c[c], std::uint32_t(mean[c]));
  return r;
}

/// Returns true if the alpha of a vertex colour is below 1.
GB_HD bool has_vertex_alpha(const Surface& s) {
  return s.has_vertex_rgba && (s.vertex_rgba[0][3] & s.vertex_rgba[1][3] & s.vertex_rgba[2][3]) != 65535;
}

/// Limits alpha to 65534. If alpha varies over a triangle, a fragment that happens to be opaque must not make its voxel
/// opaque. Otherwise the coverage of cut-out textures would depend on their division into triangles.
GB_HD Rgba16 without_opaque_alpha(Rgba16 rgba) {
  if (rgba.c[3] == 65535) rgba.c[3] = 65534;
  return rgba;
}

/// Returns the premultiplied linear RGBA of a fragment without texture.
GB_HD Rgba16 shade_untextured(const Surface& s, const double mean[4]) {
  const Rgba16 factor = factor_of(s, mean);
  if (s.is_opaque()) return opaque_colour(factor);
  const Rgba16 rgba = apply_material(s.material, factor, Rgba16{{65535, 65535, 65535, 65535}});
  return has_vertex_alpha(s) ? without_opaque_alpha(rgba) : rgba;
}

/// Returns the premultiplied linear RGBA of a fragment with texture. `factor` is straight linear RGBA and is multiplied
/// with the texture. `opaque` is as in texture_over().
template <bool opaque>
GB_HD Rgba16 shade_textured(const TextureView& texture, const MaterialView& m, const TextureMap& map,
                            const Rgba16& factor, const FragmentShape& f, const Tables& tables) {
  const Rgba16 texel = m.nearest ? nearest_over(texture, nearest_map(m, map), f, tables.linear_from_srgb)
                                 : texture_over<opaque>(texture, m, map, f, tables);
  if (opaque) return apply_opaque(factor, texel);
  const Rgba16 rgba = apply_material(m, factor, texel);
  return m.alpha_mode == AlphaMode::opaque || texture.is_opaque ? rgba : without_opaque_alpha(rgba);
}

/// Returns the premultiplied linear RGBA of a fragment. `opaque` is as in texture_over().
template <bool opaque>
GB_HD Rgba16 shade(const Surface& s, const TrianglePlane& t, const FragmentShape& f, const Tables& tables) {
  double mean[4] = {65535, 65535, 65535, 65535};
  if (s.has_vertex_rgba) {
    const Barycentric w = barycentric(t, f.centroid);
    for (int c = 0; c < 4; ++c) mean[c] = vertex_mean(s, c, w);
  }
  if (s.texture == nullptr) return shade_untextured(s, mean);
  const Rgba16 rgba = shade_textured<opaque>(*s.texture, s.material, s.map, factor_of(s, mean), f, tables);
  return !s.is_opaque() && has_vertex_alpha(s) ? without_opaque_alpha(rgba) : rgba;
}

/// Red, green and blue as linear functions of (u, v) in voxels from the anchor, multiplied by weight_scale. Their
/// integrals over a fragment are its contribution to a voxel's sums, so the fragment's centroid is not needed.
struct LinearColour {
  double at_anchor[3], per_u[3], per_v[3];
  std::uint16_t low[3], high[3];  ///< min and max of the vertices, 65535 = 1
};

GB_HD LinearColour make_linear_colour(const Surface& s, const TrianglePlane& t) {
  const double u1 = t.u[1] - t.u[0], v1 = t.v[1] - t.v[0], u2 = t.u[2] - t.u[0], v2 = t.v[2] - t.v[0];
  LinearColour r;
  for (int c = 0; c < 3; ++c) {
    const double scale = double(s.material.base_rgba[c]) * (1.0 / 65535) * t.weight_scale;
    const std::uint16_t a = s.vertex_rgba[0][c], b = s.vertex_rgba[1][c], d = s.vertex_rgba[2][c];
    const double to_b = double(b - a) * scale * t.inverse_twice_area,
                 to_d = double(d - a) * scale * t.inverse_twice_area;
    r.per_u[c] = to_b * v2 - to_d * v1;
    r.per_v[c] = to_d * u1 - to_b * u2;
    r.at_anchor[c] = double(a) * scale - (r.per_u[c] * t.u[0] + r.per_v[c] * t.v[0]);
    r.low[c] = scale16(s.material.base_rgba[c], smaller(smaller(a, b), d));
    r.high[c] = scale16(s.material.base_rgba[c], larger(larger(a, b), d));
  }
  return r;
}

/// Returns the integral of channel c over the fragment in cell (u, v), whose moments are `m`. Due to rounding, the
/// result may lie outside 0 … 65535 · weight.
GB_HD double integral_of(const LinearColour& l, int c, double u, double v, const CellMoments& m) {
  return ((l.at_anchor[c] + l.per_u[c] * u) + l.per_v[c] * v) * m.area + (l.per_u[c] * m.u + l.per_v[c] * m.v);
}

/// Returns channel c of a fragment below min_centroid_area: the value at the cell's centre, clamped to the vertices'
/// range.
GB_HD std::uint16_t colour_near(const LinearColour& l, int c, double u, double v, double weight_scale) {
  const double at_centre = ((l.at_anchor[c] + l.per_u[c] * (u + 0.5)) + l.per_v[c] * (v + 0.5)) / weight_scale;
  const double low = l.low[c], high = l.high[c];
  return std::uint16_t(at_centre > low ? (at_centre < high ? at_centre : high) : low);
}

GB_HD Fragment linear_fragment(const LinearColour& l, double u, double v, const CellMoments& m, double weight_scale,
                               const Vec3<std::int16_t>& normal, std::int16_t offset) {
  Fragment f{weight_of(m.area, weight_scale), 65535, {0, 0, 0}, normal, offset};
  if (!has_centroid(m.area)) {
    for (int c = 0; c < 3; ++c) f.colour[c] = f.weight * colour_near(l, c, u, v, weight_scale);
    return f;
  }
  const double maximum = double(f.weight) * 65535;
  for (int c = 0; c < 3; ++c) {
    const double x = integral_of(l, c, u, v, m);
    f.colour[c] = floor_to_int64((x > 0 ? (x < maximum ? x : maximum) : 0) + 0.5);
  }
  return f;
}

}  // namespace gigabake::kernels
