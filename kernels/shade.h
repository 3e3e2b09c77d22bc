/// What a material looks like on a fragment: linear, premultiplied 16-bit RGBA, integrated over the fragment's
/// footprint.
///
/// Vertex colours are linear over a triangle, so their value at the fragment's centroid is their exact mean. Textures
/// are read from the prefiltered pyramid at the level whose bilinear kernel has the variance of the fragment's
/// footprint, with up to 8 probes along a stretched footprint's long axis.
///
/// Exact   Texel weights are 8-bit integers and sums are integers; positions are IEEE double: host and device agree.
/// Source  Heckbert 1989 (footprints from the Jacobian); Barkans 1997 (probes along the major axis).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "kernels/coverage.h"
#include "kernels/tables.h"
#include "kernels/texture.h"
#include "kernels/types.h"

namespace gigabake::kernels {

struct MaterialView {
  std::uint16_t base_rgba[4] = {65535, 65535, 65535, 65535};  ///< linear factor, 65535 = 1
  std::uint16_t cutoff = 32768;                               ///< alpha test of AlphaMode::mask, 65535 = 1
  AlphaMode alpha_mode = AlphaMode::opaque;
  Wrap wrap_s = Wrap::repeat, wrap_t = Wrap::repeat;
  bool nearest = false;
  std::int32_t texture = -1;  ///< index into CellInput::textures
};

struct Rgba16 {
  std::uint16_t c[4];
};

GB_HD std::uint16_t scale16(std::uint32_t a, std::uint32_t b) { return std::uint16_t((a * b + 32767u) / 65535u); }

GB_HD_NOINLINE std::int32_t wrap_texel(std::int64_t i, std::int32_t size, Wrap wrap) {
  if (std::uint64_t(i) < std::uint64_t(size)) return std::int32_t(i);  // nearly always, and a division is dear
  if (wrap == Wrap::clamp_to_edge) return std::int32_t(i < 0 ? 0 : (i >= size ? size - 1 : i));
  const std::int64_t period = wrap == Wrap::repeat ? size : 2 * std::int64_t(size);
  std::int64_t r = i % period;
  if (r < 0) r += period;
  return std::int32_t(r < size ? r : period - 1 - r);
}

/// Two neighbours, the first at x0 (a whole number), wrapped.
struct TexelPair {
  std::int32_t a, b;
};
GB_HD TexelPair wrap_pair(double x0, std::int32_t size, Wrap wrap) {
  if (x0 >= 0 && x0 < size - 1) return {std::int32_t(x0), std::int32_t(x0) + 1};
  return {wrap_texel(std::int64_t(x0), size, wrap), wrap_texel(std::int64_t(x0) + 1, size, wrap)};
}

/// A texel in one load. Texels are aligned to their size.
template <int bytes>
GB_HD void copy_texel(const void* from, void* to) {
  std::memcpy(to, __builtin_assume_aligned(from, bytes), bytes);
}

/// Four premultiplied linear texels of level l. All are asked for before anything is done with the first.
GB_HD void load_texels(const TextureView& t, int l, const std::size_t at[4], const Tables& tables, Rgba16 out[4]) {
  if (l > 0) {
    const std::uint16_t* level = t.level[l];
    for (int k = 0; k < 4; ++k) copy_texel<8>(level + 4 * at[k], out[k].c);
    return;
  }
  std::uint8_t p[4][4];
  for (int k = 0; k < 4; ++k) copy_texel<4>(t.base + 4 * at[k], p[k]);
  for (int k = 0; k < 4; ++k) {
    for (int c = 0; c < 3; ++c) out[k].c[c] = tables.linear_from_srgb[p[k][c]];
    out[k].c[3] = std::uint16_t(p[k][3] * 257u);
  }
  if ((p[0][3] & p[1][3] & p[2][3] & p[3][3]) == 255) return;
  for (int k = 0; k < 4; ++k)
    for (int c = 0; c < 3; ++c) out[k].c[c] = scale16(out[k].c[c], out[k].c[3]);
}

/// Texture coordinates are at most 2^20 and images 2^28 wide; only the gradient of a degenerate sliver leads farther.
GB_HD double bounded_texel(double x) {
  constexpr double limit = 1125899906842624.0;  // 2^50
  return x < -limit ? -limit : (x > limit ? limit : x);
}

/// Bilinear sample of one level at texture coordinates (s, t).
GB_HD Rgba16 sample_level(const TextureView& view, const MaterialView& m, int l, double s, double t,
                          const Tables& tables) {
  const std::int32_t width = (view.width >> l) > 1 ? view.width >> l : 1,
                     height = (view.height >> l) > 1 ? view.height >> l : 1;
  const double x = bounded_texel(s * width - 0.5), y = bounded_texel(t * height - 0.5);
  double x0 = std::floor(x), y0 = std::floor(y);
  std::uint32_t fx = std::uint32_t((x - x0) * 256), fy = std::uint32_t((y - y0) * 256);
  if (m.nearest && l == 0) {
    x0 += fx >= 128 ? 1 : 0;
    y0 += fy >= 128 ? 1 : 0;
    fx = fy = 0;
  }
  // Two rows of two texels, also where they weigh nothing. Weights sum up to 2^16.
  const TexelPair across = wrap_pair(x0, width, m.wrap_s), down = wrap_pair(y0, height, m.wrap_t);
  const std::size_t upper = std::size_t(down.a) * std::size_t(width), lower = std::size_t(down.b) * std::size_t(width);
  const std::size_t at[4] = {upper + std::size_t(across.a), upper + std::size_t(across.b),
                             lower + std::size_t(across.a), lower + std::size_t(across.b)};
  Rgba16 texel[4];
  load_texels(view, l, at, tables, texel);
  const std::uint32_t weight[4] = {(256 - fx) * (256 - fy), fx * (256 - fy), (256 - fx) * fy, fx * fy};
  Rgba16 r;
  for (int c = 0; c < 4; ++c) {
    std::uint32_t sum = 32768;
    for (int k = 0; k < 4; ++k) sum += weight[k] * texel[k].c[c];
    r.c[c] = std::uint16_t(sum >> 16);
  }
  if (l == 0 && view.mask_cutoff != 0) {  // the alpha test is made on the interpolated texel, as a renderer makes it
    if (r.c[3] < view.mask_cutoff * 257u) return Rgba16{{0, 0, 0, 0}};
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t straight = (r.c[c] * 65535u + r.c[3] / 2u) / r.c[3];
      r.c[c] = std::uint16_t(straight > 65535 ? 65535 : straight);
    }
    r.c[3] = 65535;
  }
  return r;
}

/// Texture coordinates as an affine function of a triangle's (u, v), and the footprint of one projected voxel.
struct TextureMap {
  double s0, su, sv, t0, tu, tv;  ///< s = s0 + su·u + sv·v
  double along_u, along_v;        ///< unit direction of the footprint's long axis in (u, v)
  double length;                  ///< texels that one voxel spans along it
  double level_texels;            ///< texels across the part that one probe must cover
  int probes;
};

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
  r.length = std::sqrt(half + root);
  const double across = std::sqrt(half > root ? half - root : 0);
  const double wanted = across > r.length / 8 ? across : r.length / 8;
  const double ratio = std::floor(r.length / (wanted > 1 ? wanted : 1) + 0.5);
  r.probes = ratio < 1 ? 1 : (ratio > 8 ? 8 : int(ratio));
  r.level_texels = r.length / r.probes;
  const double du = a >= b ? (a - half) + root : c, dv = a >= b ? c : (b - half) + root;
  const double norm = std::sqrt(du * du + dv * dv);
  r.along_u = norm > 0 ? du / norm : 1;
  r.along_v = norm > 0 ? dv / norm : 0;
  return r;
}

/// The levels that one probe reads: `level`, and where count is 2 the next one too, with weight `coarser` of 256.
struct LevelBlend {
  int level, count;
  std::uint32_t coarser;
};

/// For a footprint `texels` wide. A bilinear kernel on level l has the variance of a box of √3·2^l.
GB_HD LevelBlend blend_for(const TextureView& view, double texels) {
  double across = texels * 0.57735026918962576;
  int l = 0;
  while (across >= 2 && l + 1 < view.levels) {
    across *= 0.5;
    ++l;
  }
  if (across <= 1 || l + 1 >= view.levels) return {l, 1, 0};
  const std::uint32_t coarser = std::uint32_t((across >= 2 ? 1 : across - 1) * 256);
  return {l, coarser == 0 ? 1 : 2, coarser};
}

/// One probe: trilinear.
GB_HD Rgba16 sample_texture(const TextureView& view, const MaterialView& m, const LevelBlend& blend, double s, double t,
                            const Tables& tables) {
  Rgba16 r;
  GB_NO_UNROLL
  for (int step = 0; step < blend.count; ++step) {
    const Rgba16 p = sample_level(view, m, blend.level + step, s, t, tables);
    for (int c = 0; c < 4; ++c)
      r.c[c] = step == 0 ? p.c[c] : std::uint16_t((r.c[c] * (256 - blend.coarser) + p.c[c] * blend.coarser + 128) >> 8);
  }
  return r;
}

/// Mean of the texture over a fragment of the given projected area (voxel²) around (u, v).
GB_HD Rgba16 texture_over(const TextureView& view, const MaterialView& m, const TextureMap& map, double u, double v,
                          double area, const Tables& tables) {
  const double size = std::sqrt(area < 1 ? area : 1);  // a fragment smaller than the voxel has the smaller footprint
  const LevelBlend blend = blend_for(view, map.level_texels * size);
  const double inverse = 1.0 / map.probes;
  std::uint32_t sum[4] = {0, 0, 0, 0};
  GB_NO_UNROLL
  for (int i = 0; i < map.probes; ++i) {
    const double offset = size * ((i + 0.5) * inverse - 0.5);
    const double pu = u + map.along_u * offset, pv = v + map.along_v * offset;
    const Rgba16 p = sample_texture(view, m, blend, (map.s0 + map.su * pu) + map.sv * pv,
                                    (map.t0 + map.tu * pu) + map.tv * pv, tables);
    for (int c = 0; c < 4; ++c) sum[c] += p.c[c];
  }
  // Sums are below 2^20: the product's high word is the quotient.
  const std::uint64_t reciprocal = 0xffffffffu / std::uint32_t(map.probes) + 1ull;
  Rgba16 r;
  for (int c = 0; c < 4; ++c) r.c[c] = std::uint16_t((sum[c] + std::uint32_t(map.probes) / 2) * reciprocal >> 32);
  return r;
}

/// factor: straight linear RGBA (base colour × vertex colour). texel: premultiplied, or all 65535 without a texture.
GB_HD Rgba16 apply_material(const MaterialView& m, const Rgba16& factor, const Rgba16& texel) {
  std::uint32_t alpha = scale16(factor.c[3], texel.c[3]);
  Rgba16 r = texel;
  if (m.alpha_mode == AlphaMode::opaque) {
    alpha = 65535;
  } else if (m.alpha_mode == AlphaMode::mask) {
    // A texture made its own test, texel by texel; what is left here is the untextured case.
    alpha = m.texture >= 0 ? texel.c[3] : (factor.c[3] >= m.cutoff ? 65535 : 0);
  }
  const std::uint32_t premultiply = m.alpha_mode == AlphaMode::blend ? factor.c[3] : (alpha == 0 ? 0 : 65535);
  for (int c = 0; c < 3; ++c) r.c[c] = scale16(scale16(texel.c[c], factor.c[c]), premultiply);
  r.c[3] = std::uint16_t(alpha);
  return r;
}

}  // namespace gigabake::kernels
