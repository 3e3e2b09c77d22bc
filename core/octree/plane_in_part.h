/// The plane of a leaf in one of the finer voxels that the leaf describes.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/math/vec3.h"
#include "core/octree/plane.h"

namespace gigabake {

/// Returns the offset of a leaf's plane in a part of the leaf, in the unit of Plane::offset. `normal` is the leaf's
/// normal on the octahedron |x| + |y| + |z| = 127. `part` is the part's position in the leaf, in parts, of which
/// the leaf has 2^levels along an edge.
/// Range   The leaf is fully planar; 1 ≤ levels ≤ 10.
inline double offset_in_part(std::uint8_t plane, const Vec3<std::int32_t>& normal, const Vec3i64& part, int levels) {
  const double parts = std::ldexp(1.0, levels), half_edge = 1 / parts;  // in half edges of the leaf
  double at_centre = 0;
  for (int a = 0; a < 3; ++a) at_centre += normal[a] / 127.0 * (double(2 * part[a] + 1) * half_edge - 1);
  return (unpack_plane(plane).offset - max_offset * at_centre) * parts;
}

/// Returns the packed complete plane with the nearest offset.
inline std::uint8_t nearest_plane(double offset) {
  const double nearest = std::floor(offset + 0.5);
  return pack_plane(
      {int(nearest > max_offset ? max_offset : (nearest < -max_offset ? -max_offset : nearest)), max_coherence});
}

/// Returns the packed plane of a part of a leaf; nullopt if the leaf's plane does not intersect the part. The arguments
/// are as in offset_in_part().
inline std::optional<std::uint8_t> plane_in_part(std::uint8_t plane, const Vec3<std::int32_t>& normal,
                                                 const Vec3i64& part, int levels) {
  const double offset = offset_in_part(plane, normal, part, levels);
  constexpr double rounding = 0.5;
  if (std::fabs(offset) > max_offset + rounding) return {};
  return nearest_plane(offset);
}

}  // namespace gigabake
