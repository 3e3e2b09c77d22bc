/// A voxel for ray casting, and its packed form in the voxel pool.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"

namespace gigabake::kernels {

/// A voxel's contribution to a ray; 65535 represents 1. Members c[0…2] are linear RGB radiance / 2, premultiplied by
/// the mean of c[3…5]. Members c[3…5] are the coverages in a view along x, y, z. Missing voxels therefore contribute
/// zero and need no special case. The other members locate the voxel's surface.
struct CastVoxel {
  std::uint16_t c[6] = {};
  Vec3<std::int8_t> normal{};  ///< the normal, scaled to the octahedron |x| + |y| + |z| = 127; 0, 0, 0: no normal
  std::uint8_t plane = 0;      ///< code of core/octree/plane.h (0: no plane), or clear_plane
};
/// The value of CastVoxel::plane for a translucent voxel of lod 0, which has no plane.
inline constexpr std::uint8_t clear_plane = 64;
inline constexpr int cast_channels = 6;

/// A voxel in three words: radiance with 16 bits per channel, coverages in 1/255, and x and y of the normal. Only the
/// sign of the normal's z is stored, because the octahedron yields its magnitude.
///
/// word[0]  c[0] | c[1] << 16
/// word[1]  c[2] | coverage x << 16 | y << 24
/// word[2]  coverage z | normal x << 8 | y << 16 | plane << 24 | (normal z < 0) << 31
struct PackedVoxel {
  std::uint32_t word[3];
};
inline constexpr std::int8_t no_normal = -128;  ///< a value of x that no normal has

/// Packs the parts of a voxel: radiance as in CastVoxel::c, coverages in 1/255, and a point of the octahedron, or
/// no_normal as its x.
GB_HD PackedVoxel pack_voxel(const Vec3<std::uint16_t>& radiance, const Vec3<std::uint8_t>& coverage,
                             const Vec3<std::int32_t>& normal, std::uint8_t plane) {
  const std::uint32_t behind = normal[2] < 0 ? 1 : 0;
  return {{std::uint32_t(radiance[0]) | std::uint32_t(radiance[1]) << 16,
           std::uint32_t(radiance[2]) | std::uint32_t(coverage[0]) << 16 | std::uint32_t(coverage[1]) << 24,
           std::uint32_t(coverage[2]) | std::uint32_t(std::uint8_t(normal[0])) << 8 |
               std::uint32_t(std::uint8_t(normal[1])) << 16 | std::uint32_t(plane) << 24 | behind << 31}};
}

/// Packs a voxel.
/// Exact   unpack_voxel() returns the same voxel.
/// Range   Coverages are multiples of 257; the normal lies on the octahedron, or there is none.
GB_HD PackedVoxel pack_voxel(const CastVoxel& voxel) {
  Vec3<std::int32_t> normal{voxel.normal[0], voxel.normal[1], voxel.normal[2]};
  if ((normal[0] | normal[1] | normal[2]) == 0) normal[0] = no_normal;
  return pack_voxel({voxel.c[0], voxel.c[1], voxel.c[2]},
                    {std::uint8_t(voxel.c[3] / 257), std::uint8_t(voxel.c[4] / 257), std::uint8_t(voxel.c[5] / 257)},
                    normal, voxel.plane);
}

/// Returns the coverage in a view along an axis (0 … 2); 65535 represents 1.
GB_HD int coverage_along(const PackedVoxel& voxel, int axis) {
  return 257 * int((axis == 2 ? voxel.word[2] : voxel.word[1] >> (16 + 8 * axis)) & 255);
}

/// Returns channel `k` of the radiance, as CastVoxel::c.
GB_HD int radiance_channel(const PackedVoxel& voxel, int k) {
  return int((k == 1 ? voxel.word[0] >> 16 : voxel.word[k / 2]) & 65535);
}

/// Returns the sum of the coverages along the three axes, in 1/255.
GB_HD int coverage_sum(const PackedVoxel& voxel) {
  const std::uint32_t two = voxel.word[1] >> 16;
#if defined(__CUDA_ARCH__)
  return int(__dp4a(two, 0x101u, voxel.word[2] & 255));
#else
  return int((two & 255) + (two >> 8) + (voxel.word[2] & 255));
#endif
}

/// Returns the voxel's plane byte.
GB_HD std::uint8_t plane_of(const PackedVoxel& voxel) { return std::uint8_t(voxel.word[2] >> 24 & 127); }

/// Returns the components of the voxel's normal in three signed bytes x, y, z; 0 if there is no normal.
GB_HD std::uint32_t packed_normal(const PackedVoxel& voxel) {
  const std::uint32_t two = voxel.word[2] >> 8 & 0xffff;
  const int x = std::int8_t(two), y = std::int8_t(two >> 8), sign = int(voxel.word[2]) >> 31;
  const int z = 127 - (x < 0 ? -x : x) - (y < 0 ? -y : y);
  return x == no_normal ? 0 : two | (std::uint32_t((z ^ sign) - sign) & 255) << 16;
}

GB_HD CastVoxel unpack_voxel(const PackedVoxel& packed) {
  CastVoxel voxel;
  const std::uint32_t normal = packed_normal(packed);
  for (int a = 0; a < 3; ++a) {
    voxel.c[a] = std::uint16_t(radiance_channel(packed, a));
    voxel.c[3 + a] = std::uint16_t(coverage_along(packed, a));
    voxel.normal[a] = std::int8_t(normal >> 8 * a & 255);
  }
  voxel.plane = plane_of(packed);
  return voxel;
}

}  // namespace gigabake::kernels
