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
#include "kernels/body/test_texture.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// uv: 3 × (s, t). Range: finite, |s|, |t| ≤ 2^20 (checked by the caller).
GB_HD TextureMap make_texture_map(const TrianglePlane& p, const float uv[6]) {
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
  return r;
}

/// Variances and covariance of a fragment's points on its texture; in images², or in texels².
struct Spread {
  float ss, st, tt;
};

GB_HD float within_float(double x) {
  constexpr double beyond_any_image = double(1ull << 60);
  return float(x < -beyond_any_image ? -beyond_any_image : at_most(x, beyond_any_image));
}

GB_HD Spread image_spread(const TextureMap& m, const FragmentShape& f) {
  const double su = m.su * f.uu + m.sv * f.uv, sv = m.su * f.uv + m.sv * f.vv, tu = m.tu * f.uu + m.tv * f.uv,
               tv = m.tu * f.uv + m.tv * f.vv;
  return {within_float(m.su * su + m.sv * sv), within_float(m.tu * su + m.tv * sv),
          within_float(m.tu * tu + m.tv * tv)};
}

GB_HD Spread in_texels(const Spread& s, float width, float height) {
  return {s.ss * width * width, s.st * width * height, s.tt * height * height};
}

/// How a footprint is read: `parts` side by side, each with the spread `part` (images²) and a step (images) from the
/// one before, on one level.
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
GB_HD void split_stretched(float width, float height, const Spread& texels, FootprintParts& r) {
  constexpr float most_stretched = 9, least = widest_box * widest_box / 12;  // variances
  const float half = (texels.ss + texels.tt) * 0.5f, lean = (texels.ss - texels.tt) * 0.5f;
  const float root = std::sqrt(lean * lean + texels.st * texels.st), longer = half + root, shorter = half - root;
  const float ratio = longer / larger(most_stretched * shorter, least);
  if (!(ratio > 1)) return;
  r.parts = ratio < 49 ? int(std::sqrt(ratio)) + 1 : 8;
  const float x = lean >= 0 ? lean + root : texels.st, y = lean >= 0 ? texels.st : root - lean,
              inverse = 1 / std::sqrt(x * x + y * y), along_s = x * inverse / width, along_t = y * inverse / height;
  const float parts = float(r.parts), between = longer * (1 - 1 / (parts * parts));
  r.part.ss = larger(r.part.ss - between * along_s * along_s, 0.0f);
  r.part.st = r.part.st - between * along_s * along_t;
  r.part.tt = larger(r.part.tt - between * along_t * along_t, 0.0f);
  const float step = std::sqrt(12 * longer) / parts;
  r.step_s = step * along_s;
  r.step_t = step * along_t;
}

GB_HD FootprintParts footprint_parts(const TextureView& view, const Spread& images) {
  const float width = float(view.width), height = float(view.height);
  FootprintParts r{images, 0, 0, 1, 0};
  Spread texels = in_texels(images, width, height);
  if (12 * (texels.ss + texels.tt) <= widest_box * widest_box) return r;
  split_stretched(width, height, texels, r);
  texels = in_texels(r.part, width, height);
  r.level = level_of(view, larger(texels.ss, texels.tt));
  return r;
}

/// A level's texels have a spread of their own, which the box leaves to them; an image's own texels have none, being
/// what is asked for.
GB_HD LevelFootprint level_footprint(const TextureView& view, const FootprintParts& parts, bool is_turned) {
  const Spread texels = in_texels(parts.part, float(level_extent(view.width, parts.level)),
                                  float(level_extent(view.height, parts.level)));
  const float own = parts.level == 0 ? 0 : 3 - 3 / float(std::int64_t(1) << 2 * parts.level);
  const float ss = 12 * texels.ss - own, tt = 12 * texels.tt - own;
  LevelFootprint r;
  r.width = smaller(ss > narrowest_box * narrowest_box ? std::sqrt(ss) : narrowest_box, widest_box);
  r.height = smaller(tt > narrowest_box * narrowest_box ? std::sqrt(tt) : narrowest_box, widest_box);
  const float most = r.width * r.height * (1.0f / 12), covariance = is_turned ? -texels.st : texels.st;
  r.covariance = larger(-most, smaller(covariance, most));
  return r;
}

/// Mean of the texture over a fragment. opaque: for materials whose alpha is ignored; the result has none.
template <bool opaque>
GB_HD Rgba16 texture_over(const TextureView& view, const MaterialView& m, const TextureMap& map, const FragmentShape& f,
                          const Tables& tables) {
  if (!opaque && view.mask_cutoff != 0 && texels_of_voxel(map, view) <= most_tested_texels)
    return tested_over(view, m, map, f, tables);
  const FootprintParts parts = footprint_parts(view, image_spread(map, f));
  const double s = (map.s0 + map.su * f.centroid.u) + map.sv * f.centroid.v,
               t = (map.t0 + map.tu * f.centroid.u) + map.tv * f.centroid.v;
  std::uint32_t sum[4] = {0, 0, 0, 0};
  GB_NO_UNROLL
  for (int i = 0; i < parts.parts; ++i) {
    const float steps = float(i) - 0.5f * float(parts.parts - 1);
    const ImagePlace at_s = image_place(s + double(steps * parts.step_s), m.wrap_s),
                     at_t = image_place(t + double(steps * parts.step_t), m.wrap_t);
    const LevelFootprint footprint = level_footprint(view, parts, at_s.is_turned != at_t.is_turned);
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
