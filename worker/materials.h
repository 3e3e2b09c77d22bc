/// Materials as files describe them, turned into what the kernels shade with.
#pragma once

#include <cstdint>

#include "format/source/mesh.h"
#include "kernels/body/material.h"
#include "kernels/cpu/texture.h"

namespace gigabake {

/// How a material wants its image prefiltered. Materials that agree share one texture.
struct TextureRecipe {
  kernels::TextureAlpha alpha = kernels::TextureAlpha::ignore;
  std::uint8_t mask_cutoff = 0;  ///< of TextureAlpha::mask: the least 8-bit texel alpha that passes, 1 … 255
  friend bool operator==(const TextureRecipe&, const TextureRecipe&) = default;
};

struct ShadedMaterial {
  kernels::MaterialView view;  ///< `texture` is the caller's to set, when `image` is not -1
  int image = -1;              ///< index into TileMesh::images that it needs
  TextureRecipe recipe;
};

/// The alpha test of AlphaMode::mask is `factor · texel ≥ cutoff`; with a texture it becomes a threshold on texels, so
/// that the pyramid can hold the share that passes (vertex alpha then has no say). A cutoff of 0 lets everything pass:
/// opaque. A cutoff above the factor lets nothing pass: absent, and no image is asked for.
ShadedMaterial shaded_material(const Material& material);

}  // namespace gigabake
