/// A texture's texels, and what a sampler makes of them.
///
/// Space   Texels of one level; the endless plane that an image wraps to.
/// Exact   Integers, but for placing a sample in double: host and device agree.
/// Range   |s|, |t| ≤ 2^20; beyond that, where only the gradient of a degenerate sliver leads, any texel is picked.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernels/body/brick_triangle.h"
#include "kernels/body/coverage.h"
#include "kernels/body/material.h"
#include "kernels/body/sample_texture.h"
#include "kernels/body/texture_view.h"
#include "lattice/host_device.h"
#include "lattice/rules.h"

namespace gigabake::kernels {

/// s in the first of the images, or pairs of images, that look alike.
GB_HD double in_first_period(double s, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return s;
  return wrap == Wrap::repeat ? s - std::floor(s) : s - 2 * std::floor(s * 0.5);
}

/// Texel i of the endless row that an image of `size` texels wraps to. Range  |i| < 2^30.
GB_HD std::int32_t wrapped_texel(std::int32_t i, std::int32_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return i < 0 ? 0 : smaller(i, size - 1);
  const std::int32_t period = wrap == Wrap::repeat ? size : 2 * size, rest = i % period,
                     at = rest < 0 ? rest + period : rest;
  return at < size ? at : period - 1 - at;
}

/// Texels along one axis that a footprint may meet.
struct TexelSpan {
  std::int32_t first, count;  ///< of the endless row
  double middle;              ///< the centroid, from the first texel's lower border

  GB_HD std::int32_t middle_texel() const { return first + std::int32_t(at_most(middle, count - 0.5)); }
};

/// The finest level is taken at which no more than so many texels, or parts of texels, fit into a fragment's box.
inline constexpr int most_nearest_inside = 64, most_parts_inside = 320;

/// middle: of the fragment on the endless row; it reaches from middle + low to middle + high. Far beyond a clamped
/// edge the first texel is moved, since all look alike there.
GB_HD TexelSpan texels_between(double middle, double low, double high, std::int32_t size) {
  constexpr double most = most_parts_inside + 2;
  const double first = std::floor(middle + low), count = std::ceil(middle + high) - first;
  const double near = first < -most ? -most : at_most(first, 2.0 * size);
  return {std::int32_t(near), std::int32_t(count < 1 ? 1 : at_most(count, most)), middle - first};
}

/// One texel of the image, linear and premultiplied; with an alpha test it is opaque or absent.
GB_HD Rgba16 base_texel(const std::uint8_t* rgba, std::uint8_t mask_cutoff, const std::uint16_t* linear_from_srgb) {
  std::uint8_t p[4];
  copy_texel<4>(rgba, p);
  const std::uint32_t alpha = mask_cutoff == 0 ? p[3] * 257u : (p[3] >= mask_cutoff ? 65535u : 0u);
  Rgba16 r;
  for (int c = 0; c < 3; ++c) r.c[c] = scale16(linear_from_srgb[p[c]], alpha);
  r.c[3] = std::uint16_t(alpha);
  return r;
}

/// One level of a texture as a sampler wraps it.
struct TexelGrid {
  const TextureView* view;
  std::int32_t level, width, height;
  Wrap wrap_s, wrap_t;
  const Tables* tables;

  GB_HD std::size_t place(std::int32_t x, std::int32_t y) const {
    return std::size_t(wrapped_texel(y, height, wrap_t)) * std::size_t(width) + wrapped_texel(x, width, wrap_s);
  }

  /// Texel (x, y) of the endless plane.
  GB_HD Rgba16 texel(std::int32_t x, std::int32_t y) const {
    const std::size_t at = place(x, y);
    if (level == 0) return base_texel(view->base + 4 * at, view->mask_cutoff, tables->linear_from_srgb);
    Rgba16 r;
    copy_texel<8>(view->level[level] + 4 * at, r.c);
    return r;
  }

  /// Of the image: texels (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1), not tested.
  GB_HD void four_texels(std::int32_t x, std::int32_t y, Rgba16 out[4]) const {
    for (int k = 0; k < 4; ++k)
      out[k] = base_texel(view->base + 4 * place(x + (k & 1), y + (k >> 1)), 0, tables->linear_from_srgb);
  }
};

GB_HD TexelGrid texel_grid(const TextureView& view, int level, Wrap wrap_s, Wrap wrap_t, const Tables& tables) {
  return {&view, level, level_extent(view.width, level), level_extent(view.height, level), wrap_s, wrap_t, &tables};
}

/// The texel at (s, t), as a renderer picks it.
GB_HD Rgba16 nearest_texel(const TextureView& view, Wrap wrap_s, Wrap wrap_t, double s, double t,
                           const Tables& tables) {
  const TexelGrid grid = texel_grid(view, 0, wrap_s, wrap_t, tables);
  return grid.texel(texels_between(in_first_period(s, wrap_s) * grid.width, 0, 0, grid.width).first,
                    texels_between(in_first_period(t, wrap_t) * grid.height, 0, 0, grid.height).first);
}

/// What a renderer magnifies to at (s, t).
GB_HD Rgba16 magnified(const TextureView& view, Wrap wrap_s, Wrap wrap_t, double s, double t, const Tables& tables) {
  MaterialView wraps;
  wraps.wrap_s = wrap_s;
  wraps.wrap_t = wrap_t;
  Roughness unused{16};
  return sample_level<false>(view, wraps, 0, fraction_of(s, wrap_s), fraction_of(t, wrap_t), tables, unused);
}

}  // namespace gigabake::kernels
