/// What a texture looks like on a fragment: linear, premultiplied 16-bit RGBA, integrated over the fragment's
/// footprint.
///
/// Vertex colours are linear over a triangle, so their value at the fragment's centroid is their exact mean. Textures
/// are read from the prefiltered pyramid at the level whose bilinear kernel has the variance of the fragment's
/// footprint, with up to 8 probes along a stretched footprint's long axis.
///
/// Exact   Texel weights are 8-bit integers and sums are integers; positions are IEEE double, sizes IEEE float: host
///         and device agree.
/// Source  Heckbert 1989 (footprints from the Jacobian); Barkans 1997 (probes along the major axis).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "kernels/body/coverage.h"
#include "kernels/body/sample_texture.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// Texture coordinates as an affine function of a triangle's (u, v), and the footprint of one projected voxel.
struct TextureMap {
  double s0, su, sv, t0, tu, tv;  ///< s = s0 + su·u + sv·v
  double along_s, along_t;        ///< the footprint's long axis
  float level_texels;             ///< texels across the part that one probe must cover
  float inverse_probes;
  std::uint32_t reciprocal;  ///< of probes, in 2^-31, rounded up
  std::int32_t probes;
};

/// A footprint's parts that one probe each must cover: 1 to 8, each `texels` wide.
GB_HD void set_probes(int probes, double texels, TextureMap& map) {
  constexpr double beyond_any_image = 1 << 30;
  map.level_texels = float(at_most(texels, beyond_any_image));
  map.inverse_probes = 1.0f / float(probes);
  map.reciprocal = 0x80000000u / std::uint32_t(probes) + 1;
  map.probes = probes;
}

/// uv: 3 × (s, t). Range: finite, |s|, |t| ≤ 2^20 (checked by the caller).
GB_HD TextureMap make_texture_map(const TrianglePlane& p, const float uv[6], std::int32_t width, std::int32_t height) {
  TextureMap r;
  const double u1 = p.u[1] - p.u[0], v1 = p.v[1] - p.v[0], u2 = p.u[2] - p.u[0], v2 = p.v[2] - p.v[0];
  const double inverse = p.inverse_twice_area;
  const double s1 = double(uv[2]) - uv[0], s2 = double(uv[4]) - uv[0], t1 = double(uv[3]) - uv[1],
               t2 = double(uv[5]) - uv[1];
  r.su = (s1 * v2 - s2 * v1) * inverse;
  r.sv = (s2 * u1 - s1 * u2) * inverse;
  r.tu = (t1 * v2 - t2 * v1) * inverse;
  r.tv = (t2 * u1 - t1 * u2) * inverse;
  r.s0 = uv[0] - (r.su * p.u[0] + r.sv * p.v[0]);
  r.t0 = uv[1] - (r.tu * p.u[0] + r.tv * p.v[0]);
  // Singular values of the texels-per-voxel Jacobian.
  const double xu = r.su * width, xv = r.sv * width, yu = r.tu * height, yv = r.tv * height;
  const double a = xu * xu + yu * yu, b = xv * xv + yv * yv, c = xu * xv + yu * yv;
  const double half = (a + b) / 2, root = std::sqrt((a - b) * (a - b) / 4 + c * c);
  const double length = std::sqrt(half + root), across = std::sqrt(half > root ? half - root : 0);
  const double wanted = across > length / 8 ? across : length / 8;
  const double ratio = std::floor(length / (wanted > 1 ? wanted : 1) + 0.5);
  const int probes = ratio < 1 ? 1 : (ratio > 8 ? 8 : int(ratio));
  set_probes(probes, length / probes, r);
  const double du = a >= b ? (a - half) + root : c, dv = a >= b ? c : (b - half) + root;
  const double norm = std::sqrt(du * du + dv * dv), inverse_norm = inverse_or_one(norm);
  const double along_u = norm > 0 ? du * inverse_norm : 1, along_v = norm > 0 ? dv * inverse_norm : 0;
  r.along_s = r.su * along_u + r.sv * along_v;
  r.along_t = r.tu * along_u + r.tv * along_v;
  return r;
}

/// The level that a probe reads, and the next one's weight beside it, of 256.
struct LevelBlend {
  int level;
  std::uint32_t coarser;
};

/// For a footprint `texels` wide: finite, ≥ 0. A bilinear kernel on level l has the variance of a box of √3·2^l.
GB_HD LevelBlend blend_for(const TextureView& view, float texels) {
  const float across = texels * 0.57735027f;
  std::int32_t bits;  // exponent, then fraction: above 1, the level and how far it is to the next
  std::memcpy(&bits, &across, sizeof bits);
  constexpr std::int32_t one = 0x3f800000;
  const int reach = bits > one ? (bits - one) >> 15 : 0, most = (view.levels - 1) << 8, at = smaller(reach, most);
  return {at >> 8, std::uint32_t(at) & 255};
}

/// Whether a clamped image's outermost texel is repeated there: coarser levels repeat what lies inside of it too.
GB_HD bool is_beyond_edge(double s, Wrap wrap) { return wrap == Wrap::clamp_to_edge && (s < 0 || s > 1); }

/// Mean of the texture over a fragment of the given projected area (voxel²) around (u, v). opaque: for materials whose
/// alpha is ignored; the result has none. rough: whether texels differ so much, over so many of them, that the mean
/// over the fragment's own outline is wanted instead.
template <bool opaque>
GB_HD Rgba16 texture_over(const TextureView& view, const MaterialView& m, const TextureMap& map, double u, double v,
                          double area, const Tables& tables, bool& rough) {
  const float size = std::sqrt(float(at_most(area, 1)));  // a fragment smaller than the voxel has the smaller footprint
  const LevelBlend blend = blend_for(view, map.level_texels * size);
  const double s = (map.s0 + map.su * u) + map.sv * v, t = (map.t0 + map.tu * u) + map.tv * v;
  const int two = blend.coarser != 0 ? 1 : 0;  // levels, less one
  std::uint32_t sum[4] = {0, 0, 0, 0};
  rough = false;
  GB_NO_UNROLL
  for (int i = 0; i < map.probes << two; ++i) {
    const double offset = size * ((float(i >> two) + 0.5f) * map.inverse_probes - 0.5f);
    const int step = i & two;
    const Rgba16 p = sample_level<opaque>(view, m, blend.level + step, fraction_of(s + map.along_s * offset, m.wrap_s),
                                          fraction_of(t + map.along_t * offset, m.wrap_t), tables, rough);
    const std::uint32_t weight = step != 0 ? blend.coarser : 256 - blend.coarser;
    for (int c = 0; c < 4; ++c) sum[c] += weight * p.c[c];
  }
  constexpr float least_texels = 0.0625f;  // across a voxel: what is magnified more is all but even over a fragment
  rough = (rough && map.level_texels >= least_texels) || is_beyond_edge(s, m.wrap_s) || is_beyond_edge(t, m.wrap_t);
  // Sums are below 2^27, quotients of less than 2^20 exact.
  const std::uint32_t half = 128u * std::uint32_t(map.probes);
  Rgba16 r;
  for (int c = 0; c < 4; ++c) r.c[c] = std::uint16_t(std::uint64_t((sum[c] + half) >> 8) * map.reciprocal >> 31);
  return r;
}

}  // namespace gigabake::kernels
