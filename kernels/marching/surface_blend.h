/// The blended surface around a point: the blended planes of the eight voxels of one level.
///
/// The signed distances to the eight planes are interpolated like colours. They are also weighted by the amount of each
/// voxel's surface that lies on its plane. The surface is where the interpolated distance changes its sign.
/// Neighbouring points use the same continuous function, so the surface has no gaps through which rays could pass.
/// Distances are measured along octahedral normals (core/octree/plane.h), so they are up to 1.7 times too long.
/// Their zeros and signs are exact.
///
/// Exact   IEEE float: host and device return the same bits.
/// Source  Ohtake et al. 2003, "Multi-level Partition of Unity Implicits"; docs/experiments/levels.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/plane.h"
#include "kernels/marching/blended_planes.h"
#include "kernels/marching/sample.h"
#include "kernels/marching/scene.h"
#include "kernels/marching/tap_vectors.h"

namespace gigabake::kernels {

/// A translucent surface; its opacity does not depend on the viewing angle.
struct TranslucentSurface {
  float density = 1;  ///< mean alpha of the existing lod-0 voxels; 1 if all are opaque
  float across = 1;   ///< |cosine| between ray and normal: 1 if the ray is perpendicular to the surface, 0 if parallel
};

/// The volumetric residual around a point: coverage that no blended surface represents.
struct ResidualSample {
  CastSample sample;
  TranslucentSurface translucent = {};
};

/// Returns |cosine| between a unit direction and a vector of any length; 1 for a zero vector.
GB_HD float length_along(const Vec3d& direction, const Vec3<float>& n) {
  const float squared = dot(n, n);
  if (!(squared > 0)) return 1;
  return std::fabs(float(dot(direction, static_cast<Vec3d>(n)))) / std::sqrt(squared);
}

/// Returns the translucent surface at a point. Not inlined, because few points lie in translucent surfaces.
GB_HD_NOINLINE TranslucentSurface translucent_surface_at(CastCorners corners, double x, double y, double z) {
  const Vec3d direction{x, y, z};
  float there = 0, hidden = 0, across = 0;
#if defined(GB_HAS_TAP_VECTORS)
  if (corners.there() == 0) return {};
  const TapVectors taps(corners, corners.there());
  const TapInts is_covered = (taps.coverage(0) + taps.coverage(1) + taps.coverage(2)) != 0;
  const TapFloats weight = is_covered ? taps.weight : TapFloats{};
  const TapFloats along = taps.plane() == 0 ? TapFloats{} + 1 : TapNormals(taps).length_along(direction);
  const TapFloats rows[8] = {weight, weight * taps.channel(3), weight * along, {}, {}, {}, {}, {}};
  float sums[8] = {};
  sum_lanes(rows, sums);
  there = sums[0];
  hidden = sums[1];
  across = sums[2];
#else
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    const CastVoxel voxel = corners.stored(c);
    if ((voxel.c[3] | voxel.c[4] | voxel.c[5]) == 0) continue;
    const float weight = corners.weight(c);
    there += weight;
    hidden += weight * voxel.c[3];
    across += weight * (voxel.plane == 0 ? 1 : length_along(direction, vector_of_normal(voxel)));
  }
#endif
  return there > 0 ? TranslucentSurface{hidden / (there * 65535), across / there} : TranslucentSurface{};
}

/// Adds the voxel's channels, multiplied by `by`.
GB_HD void add_voxel(const PackedVoxel& voxel, float by, CastSample& sum) {
  GB_UNROLL
  for (int k = 0; k < 3; ++k) {
    sum.c[k] += by * float(radiance_channel(voxel, k));
    sum.c[3 + k] += by * float(coverage_along(voxel, k));
  }
}

/// Returns the interpolated voxels.
GB_HD CastSample interpolate(const CastCorners& corners) {
#if defined(GB_HAS_TAP_VECTORS)
  if (corners.there() == 0) return {};
  const TapVectors taps(corners, corners.there());
  return taps.sum_channels(taps.weight * (1.0f / 65535));
#else
  CastSample r;
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    add_voxel(corners.packed(c), corners.weight(c) * (1.0f / 65535), r);
  }
  return r;
#endif
}

/// A normal of a blended surface, scaled to 127 along its largest axis.
struct BlendNormal {
  ByteVector bytes;
  float squared;
};

GB_HD BlendNormal normal_of(const SurfaceBlend& blend) {
  float maximum = 0;
  Vec3<int> n;
  GB_UNROLL
  for (int a = 0; a < 3; ++a) maximum = std::fabs(blend.normal[a]) > maximum ? std::fabs(blend.normal[a]) : maximum;
  const float scale = maximum > 0 ? 127 / maximum : 0;
  GB_UNROLL
  for (int a = 0; a < 3; ++a) n[a] = int(blend.normal[a] * scale + (blend.normal[a] < 0 ? -0.5f : 0.5f));
  const ByteVector bytes = byte_vector(n[0], n[1], n[2]);
  return {bytes, float(dot(bytes, bytes))};
}

/// Returns the disagreement of a voxel's plane with the blended surface: 0 within 30°, rising to 1 at 45°. At an edge
/// between two surfaces, the blended surface may lie on neither of the two.
GB_HD float disagreement(ByteVector normal, const BlendNormal& blend) {
  const int along = dot(normal, blend.bytes);
  const float squared = 4 * (float(along) * float(along)), all = float(dot(normal, normal)) * blend.squared;
  if (squared >= 3 * all) return 0;  // most voxels of a surface take this exit, which avoids the division
  const float left = 3 - squared / all;
  return left < 1 ? left : 1;
}

/// Returns the residual: coverage that the blended surface does not represent. The residual consists of voxels without
/// a full plane, and of full planes more than 30° off the surface. A voxel with a full plane stores one coverage, which
/// its normal distributes over the axes.
GB_HD CastSample residual_sample(const CastCorners& corners, const SurfaceBlend& blend) {
  const BlendNormal normal = normal_of(blend);
  CastSample r;
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    const PackedVoxel voxel = corners.packed(c);
    if (coverage_sum(voxel) == 0) continue;
    float by = corners.weight(c) * (1.0f / 65535);
    Vec3<float> along{1, 1, 1};
    if (is_fully_planar(plane_of(voxel))) {
      const ByteVector bytes = packed_normal(voxel);
      by *= disagreement(bytes, normal);
      if (by == 0) continue;
      const OctahedronPoint n{components_of(bytes)};
      const float maximum = float(max_component(n));
      GB_UNROLL
      for (int a = 0; a < 3; ++a) along[a] = std::fabs(float(n.c[a])) / maximum;
    }
    const float mean = ((along[0] + along[1]) + along[2]) * (1.0f / 3);
    GB_UNROLL
    for (int k = 0; k < 3; ++k) {
      r.c[k] += by * mean * float(radiance_channel(voxel, k));
      r.c[3 + k] += by * along[k] * float(coverage_along(voxel, k));
    }
  }
  return r;
}

/// The class of the surface around a point.
enum class PointKind : std::uint8_t {
  residual,     ///< no plane: residual only
  translucent,  ///< some voxels belong to a translucent surface of lod 0; others may have a plane
  surface       ///< some voxels have a plane
};

/// The surface around a point, without the residual.
struct NeighbourhoodSurface {
  PointKind kind = PointKind::residual;
  SurfaceBlend blend;       ///< empty if `kind` is `residual`
  bool is_flat = false;     ///< the blended surface represents all coverage: there is no residual
  bool is_doubled = false;  ///< if there is any residual, all coverage is residual
};

/// Classifies the neighbourhood of a point in a brick of level `brick_lod`; `ray_lod` is the level of the ray. Bricks
/// of coarser levels that replace missing ones until they arrive (`waits`) are rendered by their coverages only. Bricks
/// with leaves, which describe all finer levels, are rendered like bricks of lod 0. `side` is as in blend_planes().
///
/// At lod 0, all coverage around a crease is residual, in addition to the blended surface, because planes do not
/// represent the surface there. The same applies to coverage around a translucent voxel.
GB_HD NeighbourhoodSurface classify_neighbourhood(const CastCorners& corners, int brick_lod, int ray_lod, bool waits,
                                                  ByteVector side) {
  const BlendedPlanes planes = blend_planes(corners, side);
  if (planes.bits == 0 || (brick_lod != ray_lod && waits)) return {};
  if ((planes.bits & clear_plane) != 0) return {PointKind::translucent, planes.blend};
  return {PointKind::surface, planes.blend, planes.is_flat, brick_lod == 0 || brick_lod != ray_lod};
}

/// Returns true unless the blended surface represents all coverage around the point.
GB_HD bool has_residual(const NeighbourhoodSurface& neighbourhood, bool is_covered) {
  return !neighbourhood.is_flat || (neighbourhood.is_doubled && is_covered);
}

/// Returns the residual at a point. `neighbourhood` is the result of classify_neighbourhood(). `is_covered` is true if
/// the ray has met coverage before. At lod 0, all coverage behind it is residual: a surface whose front part was
/// composited as cubes stays opaque.
GB_HD ResidualSample volumetric_residual(const CastCorners& corners, const NeighbourhoodSurface& neighbourhood,
                                         const Vec3d& direction, bool is_covered) {
  if (!has_residual(neighbourhood, is_covered)) return {};
  const bool is_full = neighbourhood.is_doubled && is_covered;
  if (neighbourhood.kind == PointKind::surface) {
    const CastSample residual = residual_sample(corners, neighbourhood.blend);
    return {is_full || (neighbourhood.is_doubled && residual.mean_coverage() > 0) ? interpolate(corners) : residual,
            {}};
  }
  return {interpolate(corners), neighbourhood.kind == PointKind::translucent
                                    ? translucent_surface_at(corners, direction[0], direction[1], direction[2])
                                    : TranslucentSurface{}};
}

/// Returns the colour and coverage of the blended surface, without the residual.
GB_HD CastSample surface_sample(const CastCorners& corners) {
#if defined(GB_HAS_TAP_VECTORS)
  if (corners.there() == 0) return {};
  const TapVectors taps(corners, corners.there());
  return taps.sum_channels(taps.weight * taps.blend_weight() * (1.0f / 65535));
#else
  CastSample r;
  GB_NO_UNROLL
  for (std::uint32_t left = corners.there(); left != 0; left &= left - 1) {
    const int c = lowest_one(left);
    const PackedVoxel voxel = corners.packed(c);
    add_voxel(voxel, corners.weight(c) * blend_weight(voxel) * (1.0f / 65535), r);
  }
  return r;
#endif
}

/// Returns the fraction of a surface's part in one column of voxels that lies in two given voxels of the column. `at`
/// is the position at which the surface intersects the column's axis: 0 and 1 are the centres of the two voxels.
/// `reach` is the extent, in voxels, of the surface up and down from `at` within the column.
GB_HD float part_in_pair(float at, float reach) {
  const float from = at - reach, to = at + reach;
  const float low = from > -0.5f ? from : -0.5f, high = to < 1.5f ? to : 1.5f;
  return high > low ? (high - low) / (2 * reach) : 0;
}

/// The opacity of a surface at a point. It is below 1 near the border even of an opaque surface. The member `density`
/// is the opacity that the surface has away from its border.
struct SurfaceOpacity {
  float opacity = 1, density = 1;
};

/// The min extent `reach` in voxels. It covers the errors of a plane: its offset has steps of 1/14 voxel, and its
/// normal is known to a few degrees.
inline constexpr float min_reach = 0.125f;

/// Returns v[axis] without indexing, because a device cannot keep an array with a computed index in registers.
GB_HD float component(const Vec3<float>& v, int axis) { return axis == 0 ? v[0] : (axis == 1 ? v[1] : v[2]); }

/// The columns of voxels around a point, along the axis closest to the surface's normal. The point lies between columns
/// (0, 0) and (1, 1).
struct SurfaceColumns {
  BrickView brick;
  Vec3<int> base;
  int along, u, v;  ///< axes
  float slope_u, slope_v, reach;
  Vec3<float> at;  ///< position of the point between the voxels along `along`, u and v

  /// Returns the fraction of the tangent plane in column (i, j) that lies in the column's two voxels.
  GB_HD float part(int i, int j) const {
    return part_in_pair(at[0] - (slope_u * (float(i) - at[1]) + slope_v * (float(j) - at[2])), reach);
  }

  /// Returns the sum of the coverages of the two voxels of column (i, j), in a view along the column's axis. The sum is
  /// exact for a single surface, because the two voxels hold different parts of it.
  GB_HD float together(int i, int j) const {
    const int x = base[0] + (u == 0 ? i : 0);
    const int y = base[1] + (u == 1 ? i : (v == 1 ? j : 0));
    const int z = base[2] + (v == 2 ? j : 0);
    const int low = coverage_at(brick, x, y, z, along);
    const int high =
        coverage_at(brick, x + (along == 0 ? 1 : 0), y + (along == 1 ? 1 : 0), z + (along == 2 ? 1 : 0), along);
    return float(low + high) * (1.0f / 65535);
  }
};

GB_HD SurfaceColumns columns_around(const BrickView& brick, const CastPoint& point, const SurfaceBlend& blend) {
  const float x = std::fabs(blend.normal[0]), y = std::fabs(blend.normal[1]), z = std::fabs(blend.normal[2]);
  SurfaceColumns r;
  r.brick = brick;
  r.base = point.base;
  r.along = z > (y > x ? y : x) ? 2 : (y > x ? 1 : 0);
  r.u = r.along == 0 ? 1 : 0;
  r.v = r.along == 2 ? 1 : 2;
  const float maximum = component(blend.normal, r.along);
  r.slope_u = component(blend.normal, r.u) / maximum;
  r.slope_v = component(blend.normal, r.v) / maximum;
  r.reach = min_reach + 0.5f * (std::fabs(r.slope_u) + std::fabs(r.slope_v));
  r.at[0] = component(point.between, r.along);
  r.at[1] = component(point.between, r.u);
  r.at[2] = component(point.between, r.v);
  return r;
}

/// The min part() of a column that is used to estimate the density of a surface.
inline constexpr float min_part = 0.25f;

/// Returns the max density of the surface among the columns nearby, within the brick. The range is one and a half
/// voxels along x and y and one voxel along z. Near the border of an opaque surface some columns are full; in a
/// translucent surface no column is. The range along z is smaller, because z positions of coarse bricks depend on the
/// cells, and cells must not be visible in the image.
GB_HD float max_density_near(const SurfaceColumns& columns, const CastPoint& point) {
  const int base_u = columns.u == 0 ? point.base[0] : point.base[1];
  const int base_v = columns.v == 1 ? point.base[1] : slot_edge;  // z: only the point's own voxels
  const int first_u = base_u > 0 ? -1 : 0, last_u = base_u + 2 < slot_edge ? 2 : 1;
  const int first_v = columns.v == 1 && base_v > 0 ? -1 : 0, last_v = base_v + 2 < slot_edge ? 2 : 1;
  float max_density = 0;
  GB_NO_UNROLL
  for (int j = first_v; j <= last_v; ++j)
    for (int i = first_u; i <= last_u && max_density < 1; ++i) {
      const float part = columns.part(i, j);
      if (part < min_part) continue;
      const float together = columns.together(i, j), density = together < part ? together / part : 1;
      max_density = density > max_density ? density : max_density;
    }
  return max_density;
}

/// Returns the opacity of the surface through a point: the covered part of the tangent plane in the voxels of four
/// columns. The rest of the plane in these columns may lie in voxels above or below. If no column nearby is almost
/// full, the surface is translucent, and its density is its opacity at this point. Otherwise the uncovered part of the
/// plane lies beyond the surface's border.
GB_HD SurfaceOpacity surface_opacity(const BrickView& brick, const CastPoint& point, const SurfaceBlend& blend) {
  const SurfaceColumns columns = columns_around(brick, point, blend);
  float there = 0, met = 0;
  GB_NO_UNROLL
  for (int column = 0; column < 4; ++column) {
    const int i = column & 1, j = column >> 1;
    const float weight = (i != 0 ? columns.at[1] : 1 - columns.at[1]) * (j != 0 ? columns.at[2] : 1 - columns.at[2]);
    const float part = columns.part(i, j), together = columns.together(i, j);
    there += weight * (together < part ? together : part);
    met += weight * part;
  }
  if (!(met > 0)) return {};
  const float opacity = there / met;
  if (opacity >= 1) return {opacity, 1};
  const float max_density = max_density_near(columns, point), full = 4 * max_density - 3;
  return {opacity, full >= 1 || max_density == 0 ? 1 : (full > 0 ? opacity + (1 - opacity) * full : opacity)};
}

}  // namespace gigabake::kernels
