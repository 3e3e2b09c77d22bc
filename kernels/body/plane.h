/// The plane of a coarser voxel: a byte that says where its surface lies, if it is one sheet.
///
/// The plane is n·x = offset/7, where n is the direction of the voxel's stored normal with |x| + |y| + |z| = 1 (it is
/// not brought to unit length), and x is a place from the voxel's centre in half edges. So an offset of 7 is a plane
/// that just touches the cube, whatever its direction. The byte's lowest two bits say how much of the voxel's surface
/// lies on the plane, 3 being all; above them is offset + 8. 0: there is no sheet.
///
/// A voxel that is a sheet and nothing else stores no coverage along the axes: its alpha, which is the largest of them,
/// and its normal say it.
///
/// Exact   Integers of 32 bits: host and device return the same bits.
/// Source  docs/experiments/levels.md (blended planes).
#pragma once

#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake::kernels {

inline constexpr int most_coherence = 3, most_offset = 7;

struct Plane {
  std::int32_t offset = 0;     ///< -7 … 7: off by a thirtieth of a voxel, which is a thirtieth of a pixel
  std::int32_t coherence = 0;  ///< how much of the surface lies on it, 0 … 3; 0: there is no sheet
};

GB_HD std::uint8_t pack_plane(const Plane& p) {
  return std::uint8_t(p.coherence == 0 ? 0 : (p.offset + 8) << 2 | p.coherence);
}

/// Any byte is a plane, of an offset within ±8: bits that are not of it do not count.
GB_HD Plane unpack_plane(std::uint8_t byte) { return {(byte >> 2 & 15) - 8, byte & 3}; }

GB_HD bool is_all_sheet(std::uint8_t plane) { return (plane & 3) == most_coherence; }

/// Of the octahedron |x| + |y| + |z| = 127.
struct OctahedronPoint {
  std::int32_t c[3];
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

/// The largest of |x|, |y| and |z|: at least 43.
GB_HD std::int32_t largest_of(const OctahedronPoint& n) {
  const std::int32_t x = n.c[0] < 0 ? -n.c[0] : n.c[0], y = n.c[1] < 0 ? -n.c[1] : n.c[1],
                     z = n.c[2] < 0 ? -n.c[2] : n.c[2];
  const std::int32_t most = x > y ? x : y;
  return most > z ? most : z;
}

}  // namespace gigabake::kernels
