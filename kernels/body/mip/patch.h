/// Surface moments of a coarser voxel: mean position and flatness of its surface. Planes are fitted to them
/// (core/octree/plane.h).
///
/// A voxel's *patch* is kept next to its level while coarser levels are computed, and is not stored. Positions are
/// relative to the centre of the patch's voxel, in half edges of that voxel. They lie between -1 and 1 at every level.
///
/// Exact   32-bit integers, rounded once per level; the order of children does not matter. Host and device return the
///         same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "core/octree/plane.h"
#include "kernels/body/mip/mip.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Surface moments of one voxel. The struct has eight bytes, so that a GPU reads it with one load.
struct alignas(8) SurfaceMoments {
  Vec3<std::int16_t> place;       ///< mean position of the surface; position_unit is half an edge
  std::uint8_t spread;            ///< mean squared distance of the surface from its plane; 256 = 1, max 255; at lod 0
                                  ///< 0 or unknown_spread
  std::uint8_t normal_coherence;  ///< 256 · length of the mean of its unit normals, minus 1
};

inline constexpr std::int32_t position_unit = 1 << 14;

/// Value of `spread` in the patch of a lod-0 voxel without a plane: the position of its surface is unknown.
inline constexpr std::uint8_t unknown_spread = 255;

/// Returns the patch of a lod-0 voxel without a plane. Its position is the voxel's centre.
GB_HD SurfaceMoments patch_without_plane() { return {{0, 0, 0}, unknown_spread, 255}; }

/// Returns the patch of a lod-0 voxel with unit normal `n`. Its position is the point of the plane that is nearest to
/// the voxel's centre. It needs no division: |x| + |y| + |z| of `n` is the inverse length of the plane's normal
/// (core/octree/plane.h).
GB_HD SurfaceMoments finest_patch(std::uint8_t plane, const UnitNormal& n) {
  if (plane == 0) return patch_without_plane();
  const std::int32_t distance = sum_of_magnitudes(n.c) * unpack_plane(plane).offset / (2 * max_offset);
  return {static_cast<Vec3<std::int16_t>>((n.c * distance + Vec3<std::int32_t>::all(1 << 14)) >> 15), 0, 255};
}

/// Sums over the children of a voxel, each weighted by its visible coverage (Weights), as for colour.
struct PatchSums {
  std::int32_t weight = 0;
  Vec3<std::int32_t> place{}, normal{};

  /// Returns the mean position of a child's surface, relative to the parent's centre. Half an edge of the parent is
  /// 2·position_unit.
  GB_HD static Vec3<std::int32_t> place_in_parent(const SurfaceMoments& patch, int child) {
    return Vec3<std::int32_t>::by_axis(
        [&](int axis) { return ((child >> axis & 1) != 0 ? position_unit : -position_unit) + patch.place[axis]; });
  }

  /// Adds a child with unit normal `n` and weight `w` (0 … 255).
  GB_HD void add(const SurfaceMoments& patch, int child, const UnitNormal& n, std::int32_t w) {
    weight += w;
    place += place_in_parent(patch, child) * w;
    normal += (n.c * (patch.normal_coherence + 1) >> 8) * w;
  }

  /// Returns 2^31 / weight. All means multiply by it, so that there is only one division.
  /// Range   weight > 0.
  GB_HD std::int64_t by_weight() const { return (std::uint32_t(1) << 31) / std::uint32_t(weight); }

  /// Returns the parent's patch except for `spread`. `n` is the parent's unit normal.
  GB_HD SurfaceMoments patch(const UnitNormal& n) const {
    const std::int64_t by = by_weight();
    SurfaceMoments out{};
    constexpr std::int64_t half = std::int64_t(1) << 31;
    out.place = static_cast<Vec3<std::int16_t>>((static_cast<Vec3i64>(place) * by + Vec3i64::all(half)) >> 32);
    const auto mean_normal = static_cast<Vec3<std::int32_t>>(static_cast<Vec3i64>(normal) * by >> 31);
    const std::int32_t along = dot(mean_normal, n.c);       // below 2^30 by the Cauchy-Schwarz inequality
    const std::int32_t length = (along + (1 << 21)) >> 22;  // 256 = 1
    out.normal_coherence = std::uint8_t(length < 1 ? 0 : length - 1);
    return out;
  }
};

/// Returns the squared distance of a child's position from its parent's plane. The value 65536 is the square of half a
/// parent edge; the max is 4·65536.
GB_HD std::int32_t squared_distance_in_parent(const SurfaceMoments& of_child, int child,
                                              const SurfaceMoments& of_parent, const UnitNormal& n) {
  const Vec3<std::int32_t> apart =
      PatchSums::place_in_parent(of_child, child) / 2 - static_cast<Vec3<std::int32_t>>(of_parent.place);
  const std::int32_t off = dot(n.c >> 3, apart >> 4) >> 14;  // before the shift, 2^22 is one half edge
  return off * off;
}

/// Returns the mean squared distance of voxel centres from a plane, over the voxels that the plane intersects. The
/// value 65536 is the squared edge of these voxels. For a unit normal (x, y, z), the distances are at most (|x| + |y| +
/// |z|) / 2 edges. A lod-0 voxel without a plane has its centre as position, because the surface's position in it is
/// unknown. This distance is therefore not part of the surface's spread.
GB_HD std::int32_t spread_of_centres(const UnitNormal& n) {
  const std::int32_t reach = sum_of_magnitudes(n.c) >> 7;
  return reach * reach / 12;
}

/// Returns the patch of the parent of eight voxels. `sums` are over the children of non-zero weight; the patches of the
/// others are ignored. `is_finest` is true if the children are of lod 0.
GB_HD SurfaceMoments join_patches(const PatchSums& sums, const SurfaceMoments patches[8], const Weights& weights,
                                  const Voxel& parent, bool is_finest, const Tables& tables) {
  const UnitNormal n = unit_normal_of(parent.normal, tables);
  SurfaceMoments out = sums.patch(n);
  std::int32_t spread = 0, unknown_weight = 0;
  GB_UNROLL_ALWAYS
  for (int c = 0; c < 8; ++c) {
    const SurfaceMoments of_child = patches[c];
    const auto w = std::int32_t(weights.of(c));
#if !defined(__CUDA_ARCH__)
    if (w == 0) continue;  // as in filter_children()
#endif
    spread += w * squared_distance_in_parent(of_child, c, out, n);
    if (!is_finest) spread += w * (64 * std::int32_t(of_child.spread));
    if (is_finest && of_child.spread == unknown_spread) unknown_weight += w;
  }
  if (is_finest) spread -= unknown_weight * spread_of_centres(n);
  spread = (std::int32_t(spread * sums.by_weight() >> 31) + 128) >> 8;
  out.spread = std::uint8_t(spread < 0 ? 0 : (spread > 255 ? 255 : spread));
  return out;
}

/// A voxel and its patch, both computed from eight children.
struct VoxelPatch {
  Voxel voxel;
  SurfaceMoments patch;
};

/// Computes a voxel by filter_children<true>() and its patch by join_patches(). patch(c, n) is the patch of child c,
/// whose unit normal is `n`; it is ignored if the child's weight is 0.
template <class PatchOf>
GB_HD VoxelPatch filter_patches(const Voxel children[8], const PatchOf& patch, const Weights& weights, bool is_finest,
                                const Tables& tables) {
  SurfaceMoments patches[8] = {};
  PatchSums sums;
  const auto add = [&](int c, std::uint32_t w, const UnitNormal& stored, const UnitNormal& n) {
    patches[c] = patch(c, stored);
    sums.add(patches[c], c, n, std::int32_t(w));
  };
  VoxelPatch out;
  out.voxel = filter_children<true>(children, weights, MipFilter::coverage, tables, add);
  out.patch = join_patches(sums, patches, weights, out.voxel, is_finest, tables);
  return out;
}

}  // namespace gigabake::kernels
