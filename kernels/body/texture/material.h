/// A material's factor, alpha mode and texture, and their application to a texel.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"

namespace gigabake::kernels {

struct MaterialView {
  std::uint16_t base_rgba[4] = {65535, 65535, 65535, 65535};  ///< linear factor, 65535 = 1
  std::uint16_t cutoff = 32768;                               ///< alpha test of AlphaMode::mask, 65535 = 1
  AlphaMode alpha_mode = AlphaMode::opaque;
  Wrap wrap_s = Wrap::repeat, wrap_t = Wrap::repeat;
  bool nearest = false;
  std::int32_t texture = -1;  ///< index into CellInput::textures, -1: none; if alpha_mode is opaque, the texture has
                              ///< TextureAlpha::ignore
};

/// A part's normal map and its sampler.
struct NormalMapView {
  std::int32_t texture = -1;  ///< index into CellInput::textures, -1: none; the texture has TextureContent::directions
  float scale = 1;            ///< of x and y; finite
  Wrap wrap_s = Wrap::repeat, wrap_t = Wrap::repeat;
  bool nearest = false;
};

struct Rgba16 {
  std::uint16_t c[4];
};

GB_HD std::uint16_t scale16(std::uint32_t a, std::uint32_t b) { return std::uint16_t((a * b + 32767u) / 65535u); }

/// Applies a material that ignores alpha. The parameters are as in apply_material().
GB_HD Rgba16 apply_opaque(const Rgba16& factor, const Rgba16& texel) {
  return {
      {scale16(texel.c[0], factor.c[0]), scale16(texel.c[1], factor.c[1]), scale16(texel.c[2], factor.c[2]), 65535}};
}

/// Returns the colour of an opaque material without a texture.
GB_HD Rgba16 opaque_colour(const Rgba16& factor) { return {{factor.c[0], factor.c[1], factor.c[2], 65535}}; }

/// Returns the material's factor without vertex colours.
GB_HD Rgba16 base_factor(const MaterialView& m) {
  return {{m.base_rgba[0], m.base_rgba[1], m.base_rgba[2], m.base_rgba[3]}};
}

/// Applies a material to a texel. `factor` is straight linear RGBA: base colour × vertex colour. `texel` is
/// premultiplied; without a texture, all its channels are 65535.
GB_HD Rgba16 apply_material(const MaterialView& m, const Rgba16& factor, const Rgba16& texel) {
  if (m.alpha_mode == AlphaMode::opaque) return apply_opaque(factor, texel);
  std::uint32_t alpha = scale16(factor.c[3], texel.c[3]);
  // A texture has already applied the alpha test per texel. Only the untextured case remains.
  if (m.alpha_mode == AlphaMode::mask) alpha = m.texture >= 0 ? texel.c[3] : (factor.c[3] >= m.cutoff ? 65535 : 0);
  const std::uint32_t premultiply = m.alpha_mode == AlphaMode::blend ? factor.c[3] : (alpha == 0 ? 0 : 65535);
  Rgba16 r;
  for (int c = 0; c < 3; ++c) r.c[c] = scale16(scale16(texel.c[c], factor.c[c]), premultiply);
  r.c[3] = std::uint16_t(alpha);
  return r;
}

}  // namespace gigabake::kernels
