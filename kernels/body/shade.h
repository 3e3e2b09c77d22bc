/// What a texture looks like on a fragment: linear, premultiplied 16-bit RGBA, averaged over the fragment.
///
/// Vertex colours are linear over a triangle, so their value at the fragment's centroid is their exact mean. Of a
/// texture a footprint is averaged that has the centroid and the second moments of the fragment's own polygon: so what
/// a parabola describes has its exact mean, and the fragments of a voxel add up to the same however its surface is cut
/// into triangles. It is read from the prefiltered pyramid at a level where it is at most four texels wide; a stretched
/// one in up to 8 parts along its long axis.
///
/// Exact   Texel weights and sums are integers; positions and moments are IEEE double, sizes IEEE float: host and
/// device
///         agree.
/// Source  Heckbert 1989 (footprints from the Jacobian); Barkans 1997 (probes along the major axis).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "kernels/body/coverage.h"
#include "kernels/body/filter_texture.h"
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

/// Variances and covariance of a fragment's points on its texture, texels².
struct Spread {
  float ss, st, tt;
};

GB_HD Spread texel_spread(const TextureMap& m, const FragmentShape& f) {
  const float xu = m.xu * f.uu + m.xv * f.uv, xv = m.xu * f.uv + m.xv * f.vv, yu = m.yu * f.uu + m.yv * f.uv,
              yv = m.yu * f.uv + m.yv * f.vv;
  return {m.xu * xu + m.xv * xv, m.yu * xu + m.yv * xv, m.yu * yu + m.yv * yv};
}

/// How a footprint is read: `parts` side by side, each with the spread `part` (texels of level 0) and a step (images)
/// from the one before, on one level.
struct FootprintParts {
  Spread part;
  float step_s, step_t;
  int parts, level;
};

/// The finest level on which what varies by `variance` texels² is at most as wide as the widest box.
GB_HD int level_of(const TextureView& view, float variance) {
  constexpr float own = 3;  // of 12 times a coarse texel's variance, a box's and a tent's; its edge is 1
  const float ratio = (12 * variance + own) * (1 / (widest_box * widest_box + own));
  std::int32_t bits;  // exponent, then fraction
  std::memcpy(&bits, &ratio, sizeof bits);
  constexpr std::int32_t one = 0x3f800000;
  return bits > one ? smaller((((bits - one) >> 23) + 2) >> 1, view.levels - 1) : 0;
}

/// A footprint that is much longer than wide, and longer than a box of level 0 reaches, in parts along its long axis.
GB_HD void split_stretched(const TextureView& view, FootprintParts& r) {
  constexpr float most_stretched = 9, least = widest_box * widest_box / 12;  // variances
  const Spread all = r.part;
  const float half = (all.ss + all.tt) * 0.5f, lean = (all.ss - all.tt) * 0.5f;
  const float root = std::sqrt(lean * lean + all.st * all.st), longer = half + root, shorter = half - root;
  const float ratio = longer / larger(most_stretched * shorter, least);
  if (!(ratio > 1)) return;
  r.parts = ratio < 49 ? int(std::sqrt(ratio)) + 1 : 8;
  const float x = lean >= 0 ? lean + root : all.st, y = lean >= 0 ? all.st : root - lean,
              inverse = 1 / std::sqrt(x * x + y * y), along_x = x * inverse, along_y = y * inverse;
  const float parts = float(r.parts), between = longer * (1 - 1 / (parts * parts));
  r.part.ss = larger(all.ss - between * along_x * along_x, 0.0f);
  r.part.st = all.st - between * along_x * along_y;
  r.part.tt = larger(all.tt - between * along_y * along_y, 0.0f);
  const float step = std::sqrt(12 * longer) / parts;
  r.step_s = step * along_x / float(view.width);
  r.step_t = step * along_y / float(view.height);
}

/// A box of an alpha-tested image's own texels, whose alpha is taken to be a plane: a wider one looks at coarser
/// levels, which hold shares that pass.
inline constexpr float widest_tested_box = 2;

GB_HD FootprintParts footprint_parts(const TextureView& view, const Spread& spread) {
  FootprintParts r{spread, 0, 0, 1, 0};
  const float widest = view.mask_cutoff != 0 ? widest_tested_box : widest_box;
  if (12 * (spread.ss + spread.tt) <= widest * widest) return r;
  split_stretched(view, r);
  const float variance = larger(r.part.ss, r.part.tt);
  r.level = level_of(view, variance);
  if (r.level == 0 && 12 * variance > widest * widest) r.level = smaller(1, view.levels - 1);
  return r;
}

/// Twelve times the variance that a box of level l must add to that of its texels, a box's and a tent's; an image's own
/// texels have none, being what is asked for. All in texels of the level.
GB_HD Spread box_spread(const TextureView& view, const FootprintParts& parts) {
  Spread r{12 * parts.part.ss, parts.part.st, 12 * parts.part.tt};
  if (parts.level == 0) return r;
  const float x = float(level_extent(view.width, parts.level)) / float(view.width),
              y = float(level_extent(view.height, parts.level)) / float(view.height);
  const float own = 3 - 3 / float(std::int64_t(1) << 2 * parts.level);
  return {r.ss * x * x - own, r.st * x * y, r.tt * y * y - own};
}

GB_HD LevelFootprint level_footprint(const Spread& box, bool is_turned) {
  constexpr float least = narrowest_box * narrowest_box, most = widest_box * widest_box;
  LevelFootprint r;
  r.width = std::sqrt(larger(least, smaller(box.ss, most)));
  r.height = std::sqrt(larger(least, smaller(box.tt, most)));
  const float limit = r.width * r.height * (1.0f / 12), covariance = is_turned ? -box.st : box.st;
  r.covariance = larger(-limit, smaller(covariance, limit));
  return r;
}

/// Mean of the texture over a fragment. opaque: for materials whose alpha is ignored; the result has none.
template <bool opaque>
GB_HD Rgba16 texture_over(const TextureView& view, const MaterialView& m, const TextureMap& map, const FragmentShape& f,
                          const Tables& tables) {
  const FootprintParts parts = footprint_parts(view, texel_spread(map, f));
  const Spread box = box_spread(view, parts);
  const double s = (map.s0 + map.su * f.centroid.u) + map.sv * f.centroid.v,
               t = (map.t0 + map.tu * f.centroid.u) + map.tv * f.centroid.v;
  std::uint32_t sum[4] = {0, 0, 0, 0};
  GB_NO_UNROLL
  for (int i = 0; i < parts.parts; ++i) {
    const float steps = float(i) - 0.5f * float(parts.parts - 1);
    const ImagePlace at_s = image_place(s + double(steps * parts.step_s), m.wrap_s),
                     at_t = image_place(t + double(steps * parts.step_t), m.wrap_t);
    const LevelFootprint footprint = level_footprint(box, at_s.is_turned != at_t.is_turned);
    const LevelPlace place = level_place(view, parts.level, at_s, at_t);
    const Rgba16 p = filtered_sample<opaque>(view, m, parts.level, place, footprint, tables);
    for (int c = 0; c < 4; ++c) sum[c] += p.c[c];
  }
  // Sums are below 2^19 and there are at most 8 parts: quotients are exact.
  const std::uint32_t reciprocal = 0x80000000u / std::uint32_t(parts.parts) + 1;
  Rgba16 r;
  for (int c = 0; c < 4; ++c)
    r.c[c] = std::uint16_t(std::uint64_t(sum[c] + std::uint32_t(parts.parts) / 2) * reciprocal >> 31);
  return r;
}

}  // namespace gigabake::kernels
