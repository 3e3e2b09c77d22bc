#include "worker/pipeline/materials.h"

#include <algorithm>
#include <cmath>

namespace gigabake {
namespace {

/// Tolerance of the alpha test in 8-bit texel steps. The float 0.2 is slightly above 51/255, but a texel alpha of 51
/// must pass.
constexpr double cutoff_slack = 1e-4;

std::uint16_t to_16_bit(float share) {
  return std::uint16_t(std::lround(std::isfinite(share) ? std::clamp(share, 0.0f, 1.0f) * 65535.0f : 0.0f));
}

void make_invisible(ShadedMaterial& m) {
  m.image = m.normal_image = -1;
  m.view.base_rgba[3] = 0;
  m.view.cutoff = 65535;
}

void set_alpha_test(const Material& material, ShadedMaterial& m) {
  const double factor = material.base_color[3], cutoff = material.alpha_cutoff;
  if (!(cutoff > 0)) {
    m.view.alpha_mode = AlphaMode::opaque;
    return;
  }
  m.view.cutoff = to_16_bit(material.alpha_cutoff);
  if (cutoff > 1) return make_invisible(m);
  if (m.image < 0) return;
  const double threshold = std::ceil(255 * cutoff / factor - cutoff_slack);
  if (!(threshold <= 255)) return make_invisible(m);
  m.filter_key = {kernels::TextureAlpha::mask, std::uint8_t(std::max(threshold, 1.0))};
}

}  // namespace

ShadedMaterial shaded_material(const Material& material) {
  ShadedMaterial m;
  m.image = material.texture.image;
  for (std::size_t c = 0; c < 4; ++c) m.view.base_rgba[c] = to_16_bit(material.base_color[c]);
  m.view.alpha_mode = material.alpha_mode;
  m.view.wrap_s = material.texture.wrap_s;
  m.view.wrap_t = material.texture.wrap_t;
  m.view.nearest = material.texture.nearest;
  const NormalMap& map = material.normal_map;
  m.normal_image = map.texture.image;
  m.normal_map = {-1, map.scale, map.texture.wrap_s, map.texture.wrap_t, map.texture.nearest};
  if (material.alpha_mode == AlphaMode::mask) set_alpha_test(material, m);
  if (material.alpha_mode == AlphaMode::blend && m.image >= 0) m.filter_key.alpha = kernels::TextureAlpha::blend;
  return m;
}

}  // namespace gigabake
