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

/// Shades a voxel. `normal` is octahedral, or null if the scene has no normals; without a normal the voxel receives
/// light from the sky only. `coverage` holds the coverages along x, y and z; 65535 represents 1.
/// Exact   IEEE float.
GB_HD CastVoxel shade_voxel(const std::uint8_t rgba[4], const std::int8_t* normal, const CastLight& light,
                            const Tables& tables, const Vec3<std::uint16_t>& coverage) {
  CastVoxel voxel{};
  for (int a = 0; a < 3; ++a) voxel.c[3 + a] = coverage[a];
  float facing_sun = 0, up = 1;
  if (normal != nullptr) {
    const std::int16_t* n = tables.unit_normal + 4 * (std::uint8_t(normal[0]) | std::uint8_t(normal[1]) << 8);
    const float dot = (n[0] * light.to_sun[0] + n[1] * light.to_sun[1]) + n[2] * light.to_sun[2];
    facing_sun = dot > 0 ? dot * (1.0f / 32767) : 0;
    up = 0.5f + n[2] * (0.5f / 32767);
  }
  const int sum = (coverage[0] + coverage[1]) + coverage[2];
  const float weight = float(sum) * (0.5f / (3 * 65535));  // radiance is stored halved, see CastVoxel
  for (int k = 0; k < 3; ++k) {
    const float irradiance = light.sun[k] * facing_sun + (light.sky[k] * up + light.ground[k] * (1 - up));
    voxel.c[k] = to_unorm16(float(tables.linear_from_srgb[rgba[k]]) * irradiance * weight);
  }
  return voxel;
}

}  // namespace gigabake::kernels
