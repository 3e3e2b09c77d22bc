/// What a texture looks like on a fragment: linear, premultiplied 16-bit RGBA, averaged over the fragment.
///
/// Vertex colours are linear over a triangle, so their value at the fragment's centroid is their exact mean. Textures
/// are probed: 1 × 1 to 8 × 4 bilinear samples of the prefiltered pyramid, which together have the fragment's centroid
/// and the variances of its points in all directions. So a texture that a parabola describes has its exact mean, and
/// the fragments of a voxel add up to the same however its surface is cut into triangles. Where texels differ too much
/// for that, the probes say so, and the mean is that of kernels/body/covered_texels.h.
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

/// Texture coordinates as an affine function of a triangle's (u, v).
struct TextureMap {
  double s0, su, sv, t0, tu, tv;  ///< s = s0 + su·u + sv·v
  float xu, xv, yu, yv;           ///< the same gradients in texels
};

/// A gradient whose square is a float, too.
GB_HD float texels_of(double gradient) {
  constexpr double beyond_any_image = 1 << 30;
  return float(gradient < -beyond_any_image ? -beyond_any_image : at_most(gradient, beyond_any_image));
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
  r.xu = texels_of(r.su * width);
  r.xv = texels_of(r.sv * width);
  r.yu = texels_of(r.tu * height);
  r.yv = texels_of(r.tv * height);
  return r;
}

/// A fragment's spread on the texture: variances of its points, texels², along its longer and its shorter axis.
struct TexelSpread {
  float longer, shorter;
  float x, y;  ///< the longer axis' direction
};

GB_HD TexelSpread texel_spread(const TextureMap& m, const FragmentShape& f) {
  const float xx = (m.xu * m.xu * f.uu + 2 * (m.xu * m.xv) * f.uv) + m.xv * m.xv * f.vv,
              yy = (m.yu * m.yu * f.uu + 2 * (m.yu * m.yv) * f.uv) + m.yv * m.yv * f.vv,
              xy = (m.xu * m.yu * f.uu + (m.xu * m.yv + m.xv * m.yu) * f.uv) + m.xv * m.yv * f.vv;
  const float half = (xx + yy) * 0.5f, lean = (xx - yy) * 0.5f, root = std::sqrt(lean * lean + xy * xy);
  const float x = lean >= 0 ? lean + root : xy, y = lean >= 0 ? xy : root - lean;
  const float norm = std::sqrt(x * x + y * y), inverse = norm > 0 ? 1 / norm : 0;
  return {half + root, half > root ? half - root : 0, norm > 0 ? x * inverse : 1, y * inverse};
}

/// The level whose texels are at most `texels` wide: floor of the logarithm.
GB_HD int level_of_width(const TextureView& view, float texels) {
  std::int32_t bits;  // exponent, then fraction
  std::memcpy(&bits, &texels, sizeof bits);
  constexpr std::int32_t one = 0x3f800000;
  return bits > one ? smaller((bits - one) >> 23, view.levels - 1) : 0;
}

/// Below so many texels a bilinear sample at the centroid is the mean.
inline constexpr float least_probed_texels = 0.5f;
inline constexpr float most_texels_along = 4;  ///< of the level that is probed, at least

/// As many probes as texels, since tents a texel apart add up to one; at least two.
GB_HD int probes_over(float length, float texel) {
  if (length < least_probed_texels) return 1;
  const float parts = length / texel + 0.5f;
  return parts < 2 ? 2 : int(parts);
}

/// Where a fragment is probed: `along` × `across` points on one level, at most 8 × 4, in equal steps (images) about the
/// centroid.
struct Probes {
  int level, along, across;
  std::uint32_t sixteenths;  ///< Roughness that they stand
  float along_s, along_t, across_s, across_t;
};

/// Of Roughness: what brings the mean about three codes off. Two probes miss less of what is narrow, and what is left
/// between texels of coarser levels is small but all there is.
GB_HD std::uint32_t most_sixteenths(int level, float length) {
  constexpr float narrow = 2.25f;
  if (level > 0) return 1;
  return length <= narrow ? 6 : 3;
}

/// Between so many points in a row, which have the variance.
GB_HD float step_for(float variance, int points) {
  return points == 1 ? 0 : std::sqrt(12 * larger(variance, 0.0f) / float(points * points - 1));
}

/// A box has 12 times its variance as the square of its width. A level's texels have a variance of their own, a box's
/// and a tent's, which the probes' places leave to them; an image's own texels have none, being what is asked for.
GB_HD Probes probes_for(const TextureView& view, const TexelSpread& spread) {
  const float length = std::sqrt(12 * spread.longer), width = std::sqrt(12 * spread.shorter);
  const float wanted = larger(width * 0.5f, length * (1 / most_texels_along));
  Probes r;
  r.level = level_of_width(view, wanted);
  const float texel = float(1 << r.level), own = r.level > 0 ? texel * texel * 0.25f : 0;
  r.along = smaller(probes_over(length, texel), 8);
  r.across = smaller(probes_over(width, texel), 4);
  r.sixteenths = most_sixteenths(r.level, length);
  const float along = step_for(spread.longer - own, r.along), across = step_for(spread.shorter - own, r.across);
  const float image_x = 1 / float(view.width), image_y = 1 / float(view.height);
  r.along_s = along * spread.x * image_x;
  r.along_t = along * spread.y * image_y;
  r.across_s = -across * spread.y * image_x;
  r.across_t = across * spread.x * image_y;
  return r;
}

/// Whether a clamped image's outermost texel is repeated there: coarser levels repeat what lies inside of it too.
GB_HD bool is_beyond_edge(double s, Wrap wrap) { return wrap == Wrap::clamp_to_edge && (s < 0 || s > 1); }

/// Of probes about (s, t): whether the mean by probes would be some codes wrong.
GB_HD bool is_too_rough(const Roughness& rough, const TexelSpread& spread, const MaterialView& m, double s, double t) {
  constexpr float least_variance =
      1.0f / (12 * 16 * 16);  // of a sixteenth of a texel: over it a texture is all but even
  return (rough.found && spread.longer >= least_variance) || is_beyond_edge(s, m.wrap_s) || is_beyond_edge(t, m.wrap_t);
}

/// Mean of the texture over a fragment. opaque: for materials whose alpha is ignored; the result has none. rough:
/// whether texels differ too much for it.
template <bool opaque>
GB_HD Rgba16 texture_over(const TextureView& view, const MaterialView& m, const TextureMap& map, const FragmentShape& f,
                          const Tables& tables, bool& rough) {
  const TexelSpread spread = texel_spread(map, f);
  const Probes probes = probes_for(view, spread);
  const double s = (map.s0 + map.su * f.centroid.u) + map.sv * f.centroid.v,
               t = (map.t0 + map.tu * f.centroid.u) + map.tv * f.centroid.v;
  const float first_along = -0.5f * float(probes.along - 1), first_across = -0.5f * float(probes.across - 1);
  const int count = probes.along * probes.across;
  std::uint32_t sum[4] = {0, 0, 0, 0};
  Roughness found{probes.sixteenths};
  float a = first_along, b = first_across;
  GB_NO_UNROLL
  for (int i = 0; i < count; ++i) {
    const Rgba16 p = sample_level<opaque>(
        view, m, probes.level, fraction_of(s + double(a * probes.along_s + b * probes.across_s), m.wrap_s),
        fraction_of(t + double(a * probes.along_t + b * probes.across_t), m.wrap_t), tables, found);
    for (int c = 0; c < 4; ++c) sum[c] += p.c[c];
    a += 1;
    if (a <= -first_along) continue;
    a = first_along;
    b += 1;
  }
  rough = is_too_rough(found, spread, m, s, t);
  // Sums are below 2^21 and there are at most 32 probes: quotients are exact.
  const std::uint32_t reciprocal = 0x80000000u / std::uint32_t(count) + 1;
  Rgba16 r;
  for (int c = 0; c < 4; ++c)
    r.c[c] = std::uint16_t(std::uint64_t(sum[c] + std::uint32_t(count) / 2) * reciprocal >> 31);
  return r;
}

}  // namespace gigabake::kernels
