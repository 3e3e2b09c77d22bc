/// Bilinear samples of one level of a texture.
///
/// Space   Texture coordinates run from 0 to 1 over the image. Along each axis a sample's position is a fraction of the
///         image in 2^-32. It is wrapped once for all levels, so that levels need neither divisions nor doubles.
/// Exact   A coordinate is rounded once, to 2^-31 of the image. All other arithmetic is on integers: host and device
///         agree.
/// Range   |s|, |t| ≤ 2^20. Only gradients of degenerate slivers produce larger values; the texel that is sampled is
///         then arbitrary.
#pragma once

#include <cstdint>
#include <cstring>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "kernels/body/tables.h"
#include "kernels/body/texture/material.h"
#include "kernels/body/texture/texture_view.h"

namespace gigabake::kernels {

/// Returns the lower half of a double's bits.
GB_HD std::uint32_t low_word(double x) {
#if defined(__CUDA_ARCH__)
  return std::uint32_t(__double2loint(x));
#else
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return std::uint32_t(bits);
#endif
}

/// Returns the position of s on the image, in 2^-32 of the image. Adding 1.5 · 2^21 gives a double between 2^21 and
/// 2^22, whose last bit is 2^-31. The highest of its low 32 bits is set if s lies in an odd image; mirrored_repeat
/// mirrors odd images.
GB_HD std::uint32_t fraction_of(double s, Wrap wrap) {
  constexpr double last = 1 - 1.0 / 2147483648.0;
  if (wrap == Wrap::clamp_to_edge) s = s < 0 ? 0 : (s > last ? last : s);
  const std::uint32_t bits = low_word(s + 3145728.0);
  const bool is_turned = wrap == Wrap::mirrored_repeat && bits >> 31 != 0;
  return (is_turned ? ~bits : bits) << 1;
}

/// Two neighbouring texels along an axis, and the weight of the second in units of 1/256, 0 … 255.
struct TexelPair {
  std::uint32_t a, b, second;
};

/// Returns the texels around a fraction of `size` texels. If the image is not repeated, its outermost texels continue
/// beyond it; this also holds for mirrored images.
GB_HD TexelPair neighbours(std::uint32_t fraction, std::uint32_t size, bool repeats) {
  const std::int64_t x =
      std::int64_t(std::uint64_t(fraction) * size) - (std::int64_t(1) << 31);  // 2^-32 texels from texel 0's middle
  const auto i = std::int32_t(x >> 32);
  const auto last = std::int32_t(size - 1);
  const std::int32_t a = i < 0 ? (repeats ? last : 0) : i, b = i < last ? i + 1 : (repeats ? 0 : last);
  return {std::uint32_t(a), std::uint32_t(b), std::uint32_t(x) >> 24};
}

/// Copies a texel with one load. Texels are aligned to their size.
template <int bytes>
GB_HD void copy_texel(const void* from, void* to) {
  std::memcpy(to, __builtin_assume_aligned(from, bytes), bytes);
}

/// Loads `count` premultiplied linear texels of level l. All loads are issued before the first result is used. If
/// `opaque`, alpha is ignored.
template <bool opaque, int count = 4>
GB_HD void load_texels(const TextureView& t, int l, const std::uint32_t at[count], const Tables& tables,
                       Rgba16 out[count]) {
  if (l > 0) {
    const std::uint16_t* level = t.level[l];
    for (int k = 0; k < count; ++k) copy_texel<8>(level + 4 * std::size_t(at[k]), out[k].c);
    return;
  }
  std::uint8_t p[count][4];
  for (int k = 0; k < count; ++k) copy_texel<4>(t.base + 4 * std::size_t(at[k]), p[k]);
  for (int k = 0; k < count; ++k) {
    for (int c = 0; c < 3; ++c) out[k].c[c] = tables.linear_from_srgb[p[k][c]];
    out[k].c[3] = std::uint16_t(p[k][3] * 257u);
  }
  std::uint32_t alphas = 255;
  for (int k = 0; k < count; ++k) alphas &= p[k][3];
  const bool premultiplied = opaque || alphas == 255;
  for (int k = 0; k < count && !premultiplied; ++k)
    for (int c = 0; c < 3; ++c) out[k].c[c] = scale16(out[k].c[c], out[k].c[3]);
}

/// Applies the alpha test to an interpolated texel, as a renderer does.
GB_HD Rgba16 test_alpha(Rgba16 r, std::uint8_t cutoff) {
  if (r.c[3] < cutoff * 257u) return Rgba16{{0, 0, 0, 0}};
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t straight = (r.c[c] * 65535u + r.c[3] / 2u) / r.c[3];
    r.c[c] = std::uint16_t(straight > 65535 ? 65535 : straight);
  }
  r.c[3] = 65535;
  return r;
}

/// Samples a level at (s, t), which are results of fraction_of(). If `opaque`, the material ignores alpha and the
/// result has no alpha.
template <bool opaque>
GB_HD Rgba16 sample_level(const TextureView& view, const MaterialView& m, int l, std::uint32_t s, std::uint32_t t,
                          const Tables& tables) {
  const auto width = std::uint32_t(level_extent(view.width, l)), height = std::uint32_t(level_extent(view.height, l));
  const TexelPair across = neighbours(s, width, m.wrap_s == Wrap::repeat);
  const TexelPair down = neighbours(t, height, m.wrap_t == Wrap::repeat);
  // Two rows of two texels are always loaded, also if their weights are 0. Weights sum to 2^16.
  const std::uint32_t upper = down.a * width, lower = down.b * width;
  const std::uint32_t at[4] = {upper + across.a, upper + across.b, lower + across.a, lower + across.b};
  Rgba16 texel[4];
  load_texels<opaque>(view, l, at, tables, texel);
  const std::uint32_t x = across.second, y = down.second,
                      weight[4] = {(256 - x) * (256 - y), x * (256 - y), (256 - x) * y, x * y};
  Rgba16 r{{0, 0, 0, 0}};
  for (int c = 0; c < (opaque ? 3 : 4); ++c) {
    std::uint32_t sum = 32768;
    for (int k = 0; k < 4; ++k) sum += weight[k] * texel[k].c[c];
    r.c[c] = std::uint16_t(sum >> 16);
  }
  return !opaque && l == 0 && view.mask_cutoff != 0 ? test_alpha(r, view.mask_cutoff) : r;
}

}  // namespace gigabake::kernels
