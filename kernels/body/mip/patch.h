/// Surface moments of a coarser voxel: mean position and flatness of its surface. Planes are fitted to them
/// (kernels/body/mip/plane.h).
///
/// A voxel's *patch* is kept next to its level while coarser levels are computed, and is not stored. Lengths are in
/// half edges of the patch's own voxel, from its centre, so that they lie between -1 and 1 in every level.
///
/// Exact   32-bit integers, rounded once per level; the order of children does not matter. Host and device return the
///         same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "kernels/body/mip/mip.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Surface moments of one voxel. Eight bytes, so that a GPU reads them with one load.
struct alignas(8) SurfaceMoments {
  std::int16_t place[3];          ///< mean position of the surface; position_unit = 1
  std::uint8_t spread;            ///< mean squared distance from its plane; 256 = 1, max 255
  std::uint8_t normal_coherence;  ///< length of the mean of its unit normals, minus one; 256 = 1
};

/// Returns the patch of a lod-0 voxel.
GB_HD SurfaceMoments finest_patch() { return {{0, 0, 0}, 0, 255}; }

inline constexpr std::int32_t position_unit = 1 << 14;

/// Sums over the children of a voxel, each weighted by its visible coverage (Weights), as for colour.
struct PatchSums {
  std::int32_t weight = 0, place[3] = {}, normal[3] = {};

  /// Returns a child's position along an axis, from the parent's centre. Unit: half an edge of the parent is
  /// 2·position_unit.
  GB_HD static std::int32_t place_in_parent(const SurfaceMoments& patch, int child, int axis) {
    return ((child >> axis & 1) != 0 ? position_unit : -position_unit) + patch.place[axis];
  }

  /// Adds a child. n: of the child. w: 0 … 255.
  GB_HD void add(const SurfaceMoments& patch, int child, const UnitNormal& n, std::int32_t w) {
    weight += w;
    for (int a = 0; a < 3; ++a) {
      place[a] += w * place_in_parent(patch, child, a);
      normal[a] += w * ((patch.normal_coherence + 1) * n.c[a] >> 8);
    }
  }

  /// Returns 2^31 / weight: one division for all means.
  /// Range   weight > 0.
  GB_HD std::int64_t by_weight() const { return (std::uint32_t(1) << 31) / std::uint32_t(weight); }

  /// Returns the patch except for `spread`. n: of the parent.
  GB_HD SurfaceMoments patch(const UnitNormal& n) const {
    const std::int64_t by = by_weight();
    SurfaceMoments out{};
    std::int32_t along = 0;
    for (int a = 0; a < 3; ++a) {
      out.place[a] = std::int16_t((place[a] * by + (std::int64_t(1) << 31)) >> 32);
      along += std::int32_t(normal[a] * by >> 31) * n.c[a];  // below 2^30 by the Cauchy-Schwarz inequality
    }
    const std::int32_t length = (along + (1 << 21)) >> 22;  // 256 = 1
    out.normal_coherence = std::uint8_t(length < 1 ? 0 : length - 1);
    return out;
  }
};

/// Returns a child's contribution to the spread of its parent, 65536 = 1. It is the child's own spread plus the squared
/// distance of its position from the parent's plane. Max 4·65536.
GB_HD std::int32_t spread_in_parent(const SurfaceMoments& of_child, int child, const SurfaceMoments& of_parent,
                                    const UnitNormal& n) {
  std::int32_t off = 0;  // 2^22 = one half edge
  for (int a = 0; a < 3; ++a)
    off += (n.c[a] >> 3) * ((PatchSums::place_in_parent(of_child, child, a) / 2 - of_parent.place[a]) >> 4);
  off >>= 14;
  return 64 * std::int32_t(of_child.spread) + off * off;
}

/// Returns the mean squared distance of voxel centres from a plane, over the voxels that the plane intersects. Unit:
/// 65536 is an edge of these voxels, which is half an edge of the coarser voxels. The centres lie within half of (|x| +
/// |y| + |z|) of its unit normal. At lod 0 the position of the surface within a voxel is otherwise unknown.
GB_HD std::int32_t spread_of_centres(const UnitNormal& n) {
  std::int32_t reach = 0;
  for (int a = 0; a < 3; ++a) reach += n.c[a] < 0 ? -n.c[a] : n.c[a];
  reach >>= 7;
  return reach * reach / 12;
}

/// Returns the patch of the parent of eight voxels. sums: over children of non-zero weight. patch(c) is ignored if
/// child c's weight is 0. is_finest: the children are of lod 0.
template <class PatchOf>
GB_HD SurfaceMoments join_patches(const PatchSums& sums, const PatchOf& patch, const Weights& weights,
                                  const Voxel& parent, bool is_finest, const Tables& tables) {
  const UnitNormal n = unit_normal_of(parent.normal, tables);
  SurfaceMoments out = sums.patch(n);
  std::int32_t spread = 0;
  GB_UNROLL
  for (int c = 0; c < 8; ++c) spread += std::int32_t(weights.of(c)) * spread_in_parent(patch(c), c, out, n);
  spread = std::int32_t(spread * sums.by_weight() >> 31) - (is_finest ? spread_of_centres(n) : 0);
  spread = (spread + 128) >> 8;
  out.spread = std::uint8_t(spread < 0 ? 0 : (spread > 255 ? 255 : spread));
  return out;
}

/// A voxel and its patch, both computed from eight children.
struct VoxelPatch {
  Voxel voxel;
  SurfaceMoments patch;
};

/// Computes a voxel by filter_children() by view and its patch by join_patches().
template <class PatchOf>
GB_HD VoxelPatch filter_patches(const Voxel children[8], const PatchOf& patch, const Weights& weights, bool is_finest,
                                const Tables& tables) {
  PatchSums sums;
  const auto add = [&](int c, std::uint32_t w, const UnitNormal& n) { sums.add(patch(c), c, n, std::int32_t(w)); };
  VoxelPatch out;
  out.voxel = filter_children<true>(children, weights, MipFilter::coverage, tables, add);
  out.patch = join_patches(sums, patch, weights, out.voxel, is_finest, tables);
  return out;
}

}  // namespace gigabake::kernels
