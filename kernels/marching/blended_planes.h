/// The blend of the planes of the eight voxels around a point.
///
/// Exact   IEEE float: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/plane.h"
#include "kernels/marching/sample.h"
#include "kernels/marching/tap_vectors.h"

namespace gigabake::kernels {

struct SurfaceBlend {
  float weight = 0;      ///< sum of interpolation weight · blend_weight() of the existing voxels
  Vec3<float> normal{};  ///< sum of the same weights · octahedral normal, 127 represents 1
  float above = 0;       ///< sum of the same weights · signed distance of the point; 127 represents half a voxel

  /// Returns the point's signed distance in voxels; 0 if there is no surface.
  GB_HD float signed_distance() const { return weight > 0 ? above / (weight * 254) : 0; }

  /// Returns the change of the signed distance per voxel along the line.
  /// Range   `weight` > 0.
  GB_HD float slope(const Vec3d& direction) const {
    return dot(normal, static_cast<Vec3<float>>(direction)) / (weight * 127);
  }
};

GB_HD int coherence_of(const CastVoxel& voxel) { return unpack_plane(voxel.plane).coherence; }

/// Returns the blend weight of a voxel's plane: coherence × mean coverage, 0 to 3. Planes of barely covered voxels are
/// unreliable. `covered` is the sum of the coverages, in 1/255.
GB_HD float blend_weight(int coherence, int covered) { return float(coherence * covered * 257) * (1.0f / (3 * 65535)); }

GB_HD float blend_weight(const PackedVoxel& voxel) {
  return blend_weight(unpack_plane(plane_of(voxel)).coherence, coverage_sum(voxel));
}

GB_HD float blend_weight(const CastVoxel& voxel) {
  return blend_weight(coherence_of(voxel), ((voxel.c[3] + voxel.c[4]) + voxel.c[5]) / 257);
}

/// A vector of three signed bytes x, y, z; the fourth byte is 0.
using ByteVector = std::uint32_t;

GB_HD ByteVector byte_vector(int x, int y, int z) {
  return std::uint32_t(x & 255) | std::uint32_t(y & 255) << 8 | std::uint32_t(z & 255) << 16;
}

GB_HD ByteVector normal_of(const CastVoxel& voxel) {
  return byte_vector(voxel.normal[0], voxel.normal[1], voxel.normal[2]);
}

GB_HD std::int32_t dot(ByteVector a, ByteVector b) {
#if defined(__CUDA_ARCH__)
  return __dp4a(int(a), int(b), 0);
#else
  std::int32_t sum = 0;
  for (int i = 0; i < 24; i += 8) sum += std::int8_t(a >> i & 255) * std::int8_t(b >> i & 255);
  return sum;
#endif
}

GB_HD Vec3<int> components_of(ByteVector v) {
  return {int(std::int8_t(v & 255)), int(std::int8_t(v >> 8 & 255)), int(std::int8_t(v >> 16 & 255))};
}

GB_HD Vec3<float> vector_of_normal(const CastVoxel& voxel) {
  return {float(voxel.normal[0]), float(voxel.normal[1]), float(voxel.normal[2])};
}

/// The blended planes of the voxels around a point.
struct BlendedPlanes {
  SurfaceBlend blend;
  int bits = 0;           ///< bitwise OR of the plane bytes
  bool is_flat = false;   ///< the voxels are one flat surface: disagreement() is 0 for each of them
  bool is_mixed = false;  ///< some normals are opposite to others
};

/// Tests whether the planes with these normals are within 12.9° of each other, whichever sides the normals point to. If
/// all planes are this close to the first plane, so is the blended plane. Rounding to bytes turns the blended normal by
/// less than half a degree. Each plane is therefore within 30° of the blended plane. `along` is the dot product of the
/// normals, `squared` the squared length of one normal, and `b` the other normal.
GB_HD bool is_same_slope(float along, float squared, ByteVector b) {
  return along * along >= 0.95f * (squared * float(dot(b, b)));
}

/// Tests whether two normals belong to similar planes but point to opposite sides: their angle is at least 135°.
/// Triangles of one surface may be wound differently. Normals at a crease of a surface are closer to each other.
GB_HD bool are_opposite(int along, float squared, ByteVector b) {
  return (along < 0) & (2 * (float(along) * float(along)) >= squared * float(dot(b, b)));
}

GB_HD bool are_opposite(ByteVector a, ByteVector b) { return are_opposite(dot(a, b), float(dot(a, a)), b); }

/// Blends the planes of the voxels. The point's position between the voxels is rounded to 1/127 voxel. The signed
/// distance to a plane is then one dot product of bytes. Planes whose normals are opposite to `side` are turned, so
/// that inconsistent winding does not cancel a surface. If `side` is 0, the first plane's normal takes its place.
GB_HD BlendedPlanes blend_planes_by_voxel(const CastCorners& corners, ByteVector side) {
  Vec3<int> place;
  GB_UNROLL
  for (int a = 0; a < 3; ++a) place[a] = int(corners.between[a] * 127 + 0.5f);
  const ByteVector from_first = byte_vector(place[0], place[1], place[2]);
  SurfaceBlend r;
  ByteVector first = 0;
  bool is_flat = true, is_mixed = false;
  int bits = 0;
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    const PackedVoxel voxel = corners.packed(c);
    const std::uint8_t plane = plane_of(voxel);
    bits |= plane;
    const ByteVector n = packed_normal(voxel);
    if (first == 0) first = n;
    if (side == 0 && plane != 0) side = n;
    const float squared = float(dot(n, n));
    is_flat = is_flat & is_fully_planar(plane) & is_same_slope(float(dot(n, first)), squared, first);
    const int along = dot(n, from_first) - dot(n, byte_vector(127 * (c & 1), 127 * (c >> 1 & 1), 127 * (c >> 2)));
    const int above = 2 * max_offset * along - 127 * 127 * unpack_plane(plane).offset;
    const bool is_turned = are_opposite(dot(n, side), squared, side);
    is_mixed = is_mixed | is_turned;
    const float by = corners.weight(c) * blend_weight(voxel), turned = is_turned ? -by : by;
    const Vec3<int> components = components_of(n);
    GB_UNROLL
    for (int a = 0; a < 3; ++a) r.normal[a] += turned * float(components[a]);
    r.weight += by;
    r.above += turned * float(above);
  }
  r.above *= 1.0f / (127 * max_offset);
  return {r, bits, is_flat, is_mixed};
}

GB_HD Vec3<float> components(ByteVector v) { return static_cast<Vec3<float>>(components_of(v)); }

#if defined(GB_HAS_TAP_VECTORS)
/// Returns are_opposite() per lane. `squared` has the squared lengths of the normals.
inline TapInts opposite_lanes(const TapNormals& n, const TapFloats& squared, const Vec3<float>& to) {
  const TapFloats along = n.dot(to);
  return (along < 0) & (2 * (along * along) >= squared * dot(to, to));
}

/// Replaces blend_planes_by_voxel() on hosts with vectors, with the same bits.
inline BlendedPlanes blend_planes_by_lane(const CastCorners& corners, ByteVector side) {
  const std::uint32_t there = corners.there();
  if (there == 0) return {{}, 0, true, false};
  const TapVectors taps(corners, there);
  const TapNormals n(taps);
  const TapInts plane = taps.plane();
  const TapFloats squared = n.squared_length();

  // The first normal, and the first normal of a plane. Lanes before the latter have no side.
  const std::uint32_t has_normal = lanes_in(squared > 0), has_plane = lanes_in((plane != 0) & taps.is_there);
  Vec3<float> first{0, 0, 0}, to_side{0, 0, 0};
  std::uint32_t has_side = 255;
  if (side != 0) {
    to_side = components(side);
  } else if ((has_normal & has_plane) != 0) {
    const int c = lowest_one(has_normal & has_plane);
    has_side = 255u << c & 255;
    to_side = n.of_lane(c);
  }
  if (has_normal != 0) first = n.of_lane(lowest_one(has_normal));

  const TapFloats along_first = n.dot(first);
  const TapInts is_same = along_first * along_first >= 0.95f * (squared * dot(first, first));
  const TapInts is_opposite = opposite_lanes(n, squared, to_side);
  const std::uint32_t flat = lanes_in(is_same & ((plane & 3) == max_coherence)),
                      turned = lanes_in(is_opposite) & has_side;

  Vec3<float> place;
  for (int a = 0; a < 3; ++a) place[a] = float(int(corners.between[a] * 127 + 0.5f));
  const TapFloats along =
      n.dot(place[0] - TapFloats{0, 127, 0, 127, 0, 127, 0, 127}, place[1] - TapFloats{0, 0, 127, 127, 0, 0, 127, 127},
            place[2] - TapFloats{0, 0, 0, 0, 127, 127, 127, 127});
  const TapFloats above = 2 * max_offset * along - 127 * 127 * taps.plane_offset();
  const TapFloats by = taps.weight * taps.blend_weight(), turned_by = is_opposite ? -by : by;
  const TapFloats rows[8] = {turned_by * n.x, turned_by * n.y, turned_by * n.z, turned_by * above, by, {}, {}, {}};
  float sums[8] = {};
  sum_lanes(rows, sums);

  int bits = 0;
  if (has_plane != 0) {
    using Longs = std::int64_t __attribute__((vector_size(32)));
    const auto words = reinterpret_cast<Longs>(plane & taps.is_there);
    const std::int64_t any = (words[0] | words[1]) | (words[2] | words[3]);
    bits = int(any | any >> 32);
  }
  const SurfaceBlend blend{sums[4], {sums[0], sums[1], sums[2]}, sums[3] * (1.0f / (127 * max_offset))};
  return {blend, bits, (there & ~flat) == 0, turned != 0};
}
#endif

/// Returns the result of blend_planes_by_voxel(), from lanes on hosts with vectors.
GB_HD BlendedPlanes blend_planes(const CastCorners& corners, ByteVector side) {
#if defined(GB_HAS_TAP_VECTORS)
  return blend_planes_by_lane(corners, side);
#else
  return blend_planes_by_voxel(corners, side);
#endif
}

}  // namespace gigabake::kernels
