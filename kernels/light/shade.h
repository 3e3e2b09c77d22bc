/// Shading of stored voxels: unshadowed light is the same for all view directions, so it is applied once, when a brick
/// is loaded.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/body/tables.h"
#include "kernels/light/lighting.h"
#include "kernels/pool/packed_voxel.h"

namespace gigabake::kernels {

/// Rounds half up and clamps to 65535.
/// Range   v ≥ 0.
GB_HD std::uint16_t to_unorm16(float v) { return std::uint16_t(v >= 65535 ? 65535 : v + 0.5f); }

/// Returns a voxel's radiance, CastVoxel::c[0…2]. `normal` is octahedral, or null if the scene has no normals. Without
/// a normal the voxel receives light from the sky only. `coverage` is the sum of coverages along x, y and z, in 1/255.
/// Exact   IEEE float.
GB_HD Vec3<std::uint16_t> shaded_radiance(const Vec3<std::uint8_t>& rgb, const std::int8_t* normal,
                                          const CastLight& light, const Tables& tables, int coverage) {
  float facing_sun = 0, up = 1;
  if (normal != nullptr) {
    const std::int16_t* n = tables.unit_normal + 4 * (std::uint8_t(normal[0]) | std::uint8_t(normal[1]) << 8);
    const float dot = (n[0] * light.to_sun[0] + n[1] * light.to_sun[1]) + n[2] * light.to_sun[2];
    facing_sun = dot > 0 ? dot * (1.0f / 32767) : 0;
    up = 0.5f + n[2] * (0.5f / 32767);
  }
  const float weight = float(257 * coverage) * (0.5f / (3 * 65535));  // radiance is stored halved, see CastVoxel
  Vec3<std::uint16_t> radiance;
  GB_UNROLL
  for (int k = 0; k < 3; ++k) {
    const float irradiance = light.sun[k] * facing_sun + (light.sky[k] * up + light.ground[k] * (1 - up));
    radiance[k] = to_unorm16(float(tables.linear_from_srgb[rgb[k]]) * irradiance * weight);
  }
  return radiance;
}

}  // namespace gigabake::kernels
