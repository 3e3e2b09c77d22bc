/// Converts materials of source files to kernel materials.
#pragma once

#include <cstdint>

#include "format/source/mesh.h"
#include "kernels/body/texture/material.h"
#include "kernels/cpu/texture/texture.h"

namespace gigabake {

/// Prefiltering of a material's image. Materials with the same image and equal recipes share one texture.
struct TextureFilterKey {
  kernels::TextureAlpha alpha = kernels::TextureAlpha::ignore;
  std::uint8_t mask_cutoff = 0;  ///< for TextureAlpha::mask: min 8-bit texel alpha that passes, 1 to 255
  kernels::TextureContent content = kernels::TextureContent::colours;
  friend bool operator==(const TextureFilterKey&, const TextureFilterKey&) = default;
};

struct ShadedMaterial {
  kernels::MaterialView view;  ///< the caller sets `texture` if `image` is not -1
  int image = -1;              ///< index into TileMesh::images, or -1
  TextureFilterKey filter_key;
  kernels::NormalMapView normal_map;  ///< the caller sets `texture` if `normal_image` is not -1
  int normal_image = -1;              ///< index into TileMesh::images, or -1
};

/// Filtering of all normal maps.
inline constexpr TextureFilterKey normal_map_filter{kernels::TextureAlpha::ignore, 0,
                                                    kernels::TextureContent::directions};

/// Filtering of all textures of ids: level 0 keeps the bytes of the image, alpha included.
inline constexpr TextureFilterKey id_texture_filter{kernels::TextureAlpha::blend, 0, kernels::TextureContent::colours};

/// Converts a material. The alpha test of AlphaMode::mask is `factor · texel ≥ cutoff`, where `factor` is the alpha of
/// the base colour. If there is a texture, the test becomes a threshold on texels. The pyramid can then store the
/// fraction of texels that pass, and vertex alpha is ignored. A cutoff of 0 lets every texel pass, so the material is
/// opaque. A cutoff above 1, or above the factor of a textured material, lets no texel pass. The material is then
/// invisible and needs no image.
ShadedMaterial shaded_material(const Material& material);

}  // namespace gigabake
