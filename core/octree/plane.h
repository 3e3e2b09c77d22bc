/// Plane of a coarser voxel: one byte with the position of its surface, if the voxel holds a single surface.
///
/// The plane is n·x = offset/7. The vector n has the direction of the voxel's stored normal with |x| + |y| + |z| = 1,
/// not unit length. The vector x is a position from the voxel's centre in half edges. A plane with offset ±7 therefore
/// touches the voxel's cube without cutting it, in any direction. The byte's lowest two bits hold the fraction of the
/// voxel's surface that lies on the plane, in thirds. The higher bits hold offset + 8. The value 0 means no plane.
///
/// A voxel whose whole surface lies on its plane stores no coverage along the axes. The voxel's normal and alpha
/// determine these coverages; alpha is their max.
///
/// Exact   32-bit integers: host and device return the same bits.
/// Source  docs/experiments/levels.md (blended planes).
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"

namespace gigabake {

inline constexpr int max_coherence = 3, max_offset = 7;

struct Plane {
  std::int32_t offset = 0;     ///< -7 … 7; rounding error about 1/30 voxel
  std::int32_t coherence = 0;  ///< fraction of the surface on the plane, in thirds; 0: no plane
};

GB_HD std::uint8_t pack_plane(const Plane& p) {
  return std::uint8_t(p.coherence == 0 ? 0 : (p.offset + 8) << 2 | p.coherence);
}

/// Returns the plane that a byte encodes. Any byte is accepted: the offset is then -8 … 7, and the highest two bits are
/// ignored.
GB_HD Plane unpack_plane(std::uint8_t byte) { return {(byte >> 2 & 15) - 8, byte & 3}; }

GB_HD bool is_fully_planar(std::uint8_t plane) { return (plane & 3) == max_coherence; }

/// Point on the octahedron |x| + |y| + |z| = 127.
struct OctahedronPoint {
  Vec3<std::int32_t> c;
};

GB_HD OctahedronPoint octahedron_point(const std::int8_t normal[2]) {
  std::int32_t x = normal[0] < -127 ? -127 : normal[0], y = normal[1] < -127 ? -127 : normal[1];
  const std::int32_t across = x < 0 ? -x : x, along = y < 0 ? -y : y, z = 127 - across - along;
  if (z < 0) {
    x = x < 0 ? along - 127 : 127 - along;
    y = y < 0 ? across - 127 : 127 - across;
  }
  return {{x, y, z}};
}

/// Returns max(|x|, |y|, |z|), which is at least 43.
GB_HD std::int32_t max_component(const OctahedronPoint& n) {
  const std::int32_t x = n.c[0] < 0 ? -n.c[0] : n.c[0], y = n.c[1] < 0 ? -n.c[1] : n.c[1],
                     z = n.c[2] < 0 ? -n.c[2] : n.c[2];
  const std::int32_t maximum = x > y ? x : y;
  return maximum > z ? maximum : z;
}

}  // namespace gigabake
