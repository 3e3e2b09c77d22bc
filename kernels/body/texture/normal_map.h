/// Tangent-space normal maps: textures of directions.
///
/// A texel's red, green and blue are x, y and z, from -1 at 0 to 1 at the max value. x points along the texture
/// coordinate s, y against t (up on the image), and z away from the surface. Texels are filtered as colours are; the
/// mean is therefore shorter than a unit vector where directions differ.
///
/// Exact   Texels are converted by a table of integers, and filtered by kernels/body/texture/shade.h.
/// Source  glTF 2.0, normalTextureInfo.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/math/vec3.h"
#include "kernels/body/tables.h"
#include "kernels/body/texture/material.h"
#include "kernels/body/texture/nearest_texture.h"
#include "kernels/body/texture/shade.h"

namespace gigabake::kernels {

/// Returns the mean of a normal map over a fragment, with components from -1 to 1. `texture` has
/// TextureContent::directions.
GB_HD Vec3d normal_map_over(const TextureView& texture, const NormalMapView& m, const TextureMap& map,
                            const FragmentShape& f, const Tables& tables) {
  Tables linear = tables;
  linear.linear_from_srgb = tables.linear_from_code;
  MaterialView sampler;
  sampler.wrap_s = m.wrap_s;
  sampler.wrap_t = m.wrap_t;
  const Rgba16 mean = m.nearest ? nearest_over(texture, nearest_map(sampler, map), f, linear.linear_from_srgb)
                                : texture_over<true>(texture, sampler, map, f, linear);
  return Vec3d::by_axis([&](int c) { return double(2 * std::int32_t(mean.c[c]) - 65535) / 65535; });
}

}  // namespace gigabake::kernels
