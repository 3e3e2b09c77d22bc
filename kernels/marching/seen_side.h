/// Light of the side of a surface that a ray meets. Voxels are lit when they are loaded, on the side to which their
/// normals point. If a ray meets the other side, the light of its samples is replaced by the light of that side.
///
/// Exact   IEEE float: host and device return the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/marching/cast_camera.h"
#include "kernels/marching/level_sampler.h"
#include "kernels/marching/sample.h"
#include "kernels/marching/surface_blend.h"

namespace gigabake::kernels {

/// Returns the signed distance of a point to the plane of one of its eight voxels, along the voxel's normal. If the
/// voxel has no plane, the plane through its centre takes its place.
GB_HD float signed_distance_to(const CastCorners& corners, int corner, const CastVoxel& voxel) {
  const Vec3<float> centre{float(corner & 1), float(corner >> 1 & 1), float(corner >> 2)};
  const int offset = coherence_of(voxel) == 0 ? 0 : unpack_plane(voxel.plane).offset;
  return dot(vector_of_normal(voxel), corners.between - centre) * (1.0f / 127) - float(offset) * (0.5f / max_offset);
}

/// The orientation of the surface around a point. Normals opposite to the first voxel's normal are turned.
struct SurfaceSide {
  Vec3<float> normal{0, 0, 0};  ///< sum of the turned normals, weighted by interpolation weight and coverage
  float signed_distance = 0;    ///< sum of the point's signed distances along the turned normals, with the same weights
  ByteVector first = 0;         ///< the first voxel's normal
  bool is_mixed = false;        ///< some normals were turned
};

GB_HD SurfaceSide surface_side_by_voxel(const CastCorners& corners) {
  SurfaceSide side;
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    const CastVoxel voxel = corners.stored(c);
    const ByteVector n = normal_of(voxel);
    if (side.first == 0) side.first = n;
    const bool is_turned = are_opposite(n, side.first);
    side.is_mixed = side.is_mixed || is_turned;
    const float by = corners.weight(c) * float((voxel.c[3] + voxel.c[4]) + voxel.c[5]), turned = is_turned ? -by : by;
    side.normal += vector_of_normal(voxel) * turned;
    side.signed_distance += turned * signed_distance_to(corners, c, voxel);
  }
  return side;
}

#if defined(GB_HAS_TAP_VECTORS)
/// The lanes of taps whose normals are opposite to a normal, and that normal.
struct OppositeLanes {
  Vec3<float> first{0, 0, 0};  ///< the first normal of the taps; 0: no tap has a normal
  TapInts is_opposite{};       ///< are_opposite()
  TapFloats squared;           ///< squared lengths of the normals

  explicit OppositeLanes(const TapNormals& n) : squared(n.squared_length()) {
    const std::uint32_t has_normal = lanes_in(squared > 0);
    if (has_normal == 0) return;
    first = n.of_lane(lowest_one(has_normal));
    is_opposite = opposite_lanes(n, squared, first);
  }
};

/// Replaces surface_side_by_voxel() on hosts with vectors, with the same bits.
inline SurfaceSide surface_side_by_lane(const CastCorners& corners, const TapVectors& taps, const TapNormals& n,
                                        const OppositeLanes& lanes) {
  const TapFloats by = taps.weight * ((taps.coverage(0) + taps.coverage(1) + taps.coverage(2)) * 257);
  const TapFloats turned = lanes.is_opposite ? -by : by;
  const TapFloats along = n.dot(corners.between[0] - TapFloats{0, 1, 0, 1, 0, 1, 0, 1},
                                corners.between[1] - TapFloats{0, 0, 1, 1, 0, 0, 1, 1},
                                corners.between[2] - TapFloats{0, 0, 0, 0, 1, 1, 1, 1});
  const TapFloats distance = along * (1.0f / 127) - taps.plane_offset() * (0.5f / max_offset);
  const TapFloats rows[8] = {n.x * turned, n.y * turned, n.z * turned, turned * distance, {}, {}, {}, {}};
  float sums[8] = {};
  sum_lanes(rows, sums);
  const ByteVector first = byte_vector(int(lanes.first[0]), int(lanes.first[1]), int(lanes.first[2]));
  return {{sums[0], sums[1], sums[2]}, sums[3], first, lanes_in(lanes.is_opposite) != 0};
}
#endif

GB_HD SurfaceSide surface_side(const CastCorners& corners) {
#if defined(GB_HAS_TAP_VECTORS)
  if (corners.there() == 0) return {};
  const TapVectors taps(corners, corners.there());
  const TapNormals n(taps);
  return surface_side_by_lane(corners, taps, n, OppositeLanes(n));
#else
  return surface_side_by_voxel(corners);
#endif
}

/// Tests whether a ray of this direction, which enters a surface near the point, meets the side to which no or not all
/// normals point. Before a ray meets that side, its points lie on that side. A ray that passes behind an edge of a
/// solid object meets normals that point away from the eye, but its points lie on the side of these normals. Not
/// inlined, because few samples enter a surface.
GB_HD_NOINLINE bool meets_other_side(CastCorners corners, double x, double y, double z) {
  const SurfaceSide side = surface_side(corners);
  const Vec3<float> direction{float(x), float(y), float(z)};
  return side.is_mixed || (side.signed_distance < 0 && dot(side.normal, direction) > 0);
}

/// The light of voxels, per channel: the light that they contain, and the light on the side that a ray meets.
struct SideLight {
  Vec3<float> stored{0, 0, 0}, seen{0, 0, 0};

  GB_HD Vec3<float> ratio() const {
    return Vec3<float>::by_axis([&](int k) { return stored[k] > 0 ? seen[k] / stored[k] : 1; });
  }
};

/// Adds the light of the eight voxels around a point. `to_eye` points to the side of the surface that is seen.
/// `of_surface` selects the weights of surface_sample(), otherwise the weights of interpolate() apply.
GB_HD void add_light_by_voxel(const CastCorners& corners, const CastLight& light, const Vec3<float>& to_eye,
                              bool of_surface, SideLight& sums) {
  const SurfaceSide side = surface_side_by_voxel(corners);
  const bool is_behind = dot(side.normal, to_eye) < 0;
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    const CastVoxel voxel = corners.stored(c);
    const ByteVector bytes = normal_of(voxel);
    const bool is_other = bytes != 0 && are_opposite(bytes, side.first) != is_behind;
    const Vec3<float> n = vector_of_normal(voxel);
    const float unit = is_other ? 1 / std::sqrt(dot(n, n)) : 0;
    const float by = corners.weight(c) * (of_surface ? blend_weight(voxel) : 1);
    for (int k = 0; k < 3; ++k) {
      const float own = by * float(voxel.c[k]), on_normal = irradiance(light, n * unit, k);
      sums.stored[k] += own;
      sums.seen[k] += is_other && on_normal > 0 ? own * (irradiance(light, n * -unit, k) / on_normal) : own;
    }
  }
}

#if defined(GB_HAS_TAP_VECTORS)
/// Returns irradiance() per lane.
inline TapFloats irradiance_of_lanes(const CastLight& light, const TapNormals& n, const TapFloats& unit, int channel) {
  const TapFloats x = n.x * unit, y = n.y * unit, z = n.z * unit;
  const TapFloats cosine = (x * light.to_sun[0] + y * light.to_sun[1]) + z * light.to_sun[2], up = 0.5f + 0.5f * z;
  return light.sun[channel] * (cosine > 0 ? cosine : TapFloats{}) +
         (light.sky[channel] * up + light.ground[channel] * (1 - up));
}

/// Replaces add_light_by_voxel() on hosts with vectors, with the same bits.
inline void add_light_by_lane(const CastCorners& corners, const CastLight& light, const Vec3<float>& to_eye,
                              bool of_surface, SideLight& sums) {
  if (corners.there() == 0) return;
  const TapVectors taps(corners, corners.there());
  const TapNormals n(taps);
  const OppositeLanes lanes(n);
  const bool is_behind = dot(surface_side_by_lane(corners, taps, n, lanes).normal, to_eye) < 0;
  const TapInts is_other = (lanes.squared > 0) & (is_behind ? ~lanes.is_opposite : lanes.is_opposite);
  const TapFloats by = of_surface ? taps.weight * taps.blend_weight() : taps.weight;
  TapFloats rows[8] = {};
  for (int k = 0; k < 3; ++k) rows[k] = rows[3 + k] = by * taps.channel(k);
  if (lanes_in(is_other) != 0) {
    const TapFloats unit = 1 / square_root(lanes.squared);
    for (int k = 0; k < 3; ++k) {
      const TapFloats on_normal = irradiance_of_lanes(light, n, unit, k);
      const TapFloats seen = rows[k] * (irradiance_of_lanes(light, n, -unit, k) / on_normal);
      rows[3 + k] = (is_other & (on_normal > 0)) ? seen : rows[k];
    }
  }
  float values[8] = {sums.stored[0], sums.stored[1], sums.stored[2], sums.seen[0], sums.seen[1], sums.seen[2]};
  sum_lanes(rows, values);
  for (int k = 0; k < 3; ++k) {
    sums.stored[k] = values[k];
    sums.seen[k] = values[3 + k];
  }
}
#endif

GB_HD void add_light(const CastCorners& corners, const CastLight& light, const Vec3<float>& to_eye, bool of_surface,
                     SideLight& sums) {
#if defined(GB_HAS_TAP_VECTORS)
  add_light_by_lane(corners, light, to_eye, of_surface, sums);
#else
  add_light_by_voxel(corners, light, to_eye, of_surface, sums);
#endif
}

/// Returns, per channel, the light on the side that a ray of this direction meets, relative to the light that the
/// interpolated voxels contain. Not inlined, because few samples need it.
GB_HD_NOINLINE Vec3<float> relative_light(CastCorners corners, CastLight light, double x, double y, double z) {
  SideLight sums;
  add_light(corners, light, {float(-x), float(-y), float(-z)}, false, sums);
  return sums.ratio();
}

/// Returns a vector to the side of the surface from which the ray comes to its current sample. Beyond the horizon of a
/// curved surface, normals of the seen side can point away from the eye: normals of voxels are rounded, and vertex
/// normals differ from the triangles. The side of the ray at the surface's first sample therefore decides, if known.
GB_HD Vec3<float> to_seen_side(const CastLine& line, const CastRay& ray) {
  if (ray.normal == 0) return static_cast<Vec3<float>>(line.direction) * -1.0f;
  return components(ray.normal) * (ray.is_behind ? -1.0f : 1.0f);
}

/// Returns the light on the side to which `to_eye` points, relative to the light of the three samples of
/// meet_surface(). They lie at `met`, and `half` before and behind it. Not inlined, because few rays need it.
GB_HD_NOINLINE Vec3<float> relative_surface_light(const CastScene& scene, CastLine line, int lod, double met,
                                                  double half, Vec3<float> to_eye) {
  LevelSampler at(scene, line, lod);
  CastPath path;
  SideLight sums;
  GB_NO_UNROLL
  for (int side = -1; side <= 1; ++side) {
    at.look(scene, line, met + side * half, false, path);
    if (!is_resident(at.place.brick)) continue;
    const CastCorners corners = corners_of(scene.brick(at.place.brick), at.point());
    add_light(corners, scene.light, to_eye, true, sums);
  }
  return sums.ratio();
}

}  // namespace gigabake::kernels
