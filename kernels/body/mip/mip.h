/// Filter for one voxel of a coarser level, from its 2×2×2 children.
///
/// Exact   Integers (colour, coverage) and IEEE double (octahedral encode): host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/math/octahedral.h"
#include "core/math/vec3.h"
#include "kernels/body/mip/directional_coverage.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxelize/resolve.h"

namespace gigabake::kernels {

/// Returns true if the filter weights children by their visibility along the axes, and false if by their coverage.
GB_HD constexpr bool filters_by_view(MipFilter filter) { return filter == MipFilter::coverage; }

/// Returns true if a voxel of level `lod` is filtered from the 64 voxels two levels below it
/// (kernels/body/mip/two_level_filter.h). Otherwise it is filtered from its eight children.
GB_HD constexpr bool is_of_64(MipFilter filter, int lod) { return filter == MipFilter::thesis && lod >= 2; }

/// Weights (0 … 255) of eight children and their parent's coverage along x, y and z, one byte per value.
struct Weights {
  std::uint32_t child[2], directional_coverage;

  GB_HD std::uint32_t of(int c) const { return child[c / 4] >> 8 * (c % 4) & 255; }
  GB_HD std::uint32_t max_directional_coverage() const {
    const std::uint32_t x = directional_coverage & 255, y = directional_coverage >> 8 & 255,
                        z = directional_coverage >> 16, xy = x > y ? x : y;
    return xy > z ? xy : z;
  }
};

/// Returns the visible coverage of each child as its weight. If all weights are 0, each existing child gets weight 1.
/// Byte c of `there` is 1 if child c exists. `edge` is the edge of the children's rasters in cells.
GB_HD Weights weights_of(const CoverageSums& seen, int edge, const std::uint32_t there[2]) {
  Weights w{};
  GB_UNROLL_ALWAYS
  for (int c = 0; c < 8; ++c)
    if ((there[c / 4] >> 8 * (c % 4) & 1) != 0) w.child[c / 4] |= seen.weight(c, edge) << 8 * (c % 4);
  if ((w.child[0] | w.child[1]) == 0) w.child[0] = there[0], w.child[1] = there[1];
  GB_UNROLL_ALWAYS
  for (int a = 0; a < 3; ++a) w.directional_coverage |= std::uint32_t(seen.directional_coverage(a, edge)) << 8 * a;
  return w;
}

/// Normal of length 32767, as stored in Tables.
struct UnitNormal {
  Vec3<std::int32_t> c;
};

GB_HD UnitNormal unit_normal_of(const std::int8_t normal[2], const Tables& tables) {
  const std::int16_t* n = tables.unit_normal + 4 * index_of_32_bits(pack_normal(normal));
#if defined(__CUDA_ARCH__)
  const short4 all = *reinterpret_cast<const short4*>(n);  // one load
  return {{all.x, all.y, all.z}};
#else
  return {{n[0], n[1], n[2]}};
#endif
}

/// Tests whether two unit normals belong to similar planes but point to opposite sides: their angle is at least 135°.
/// Triangles of one surface may be wound differently, and a thin wall has two sides.
/// Exact   Integers: the cosine is compared in units of 2^-26.
GB_HD bool are_opposite(const UnitNormal& a, const UnitNormal& b) {
  constexpr std::int32_t limit = -47452977;  // cos 135° · 8191.75²
  return dot(a.c >> 2, b.c >> 2) <= limit;
}

/// Weighted sums of the linear colours and normals of children, and the sum of the weights.
struct MipSums {
  std::uint32_t weight = 0, colour[3] = {};
  Vec3<std::int32_t> normal{};

  /// Adds a child `v` with unit normal `n` and weight `w` (0 … 255).
  GB_HD void add(const Voxel& v, const UnitNormal& n, std::uint32_t w, const Tables& tables) {
    weight += w;
    for (int k = 0; k < 3; ++k) {
      colour[k] += w * tables.linear_from_srgb[v.rgba[k]];
      normal[k] += std::int32_t(w) * n.c[k];
    }
  }

  /// Returns the filtered voxel. Its alpha is at least 1, so that an existing voxel does not vanish from a coarser
  /// level.
  /// Range   weight ≠ 0.
  GB_HD Voxel voxel(std::uint32_t alpha, const Tables& tables) const {
    Voxel out;
    for (int k = 0; k < 3; ++k) out.rgba[k] = tables.srgb_from_linear[(colour[k] + weight / 2) / weight];
    out.rgba[3] = std::uint8_t(alpha < 1 ? 1 : alpha);
    encode_octahedral(normal[0], normal[1], normal[2], out.normal);
    return out;
  }
};

/// Returns the coverage of a voxel under the filters `thesis` and `box`. `alpha_sum` is the sum of the children's
/// alphas; a missing child adds 0.
GB_HD std::uint32_t mean_coverage(std::uint32_t alpha_sum, MipFilter filter, const Tables& tables) {
  return filter == MipFilter::thesis ? tables.thesis_alpha[8 * alpha_sum] : (alpha_sum + 4) / 8;
}

/// Returns the parent of eight voxels; missing voxels must be zero. `by_view` must equal filters_by_view(filter). If it
/// is true, `weights` is the result of weights_of(), and normals opposite to that of the first child with a weight are
/// turned, so that they do not cancel each other. Otherwise `weights` is unused. each(c, w, stored, n) is called with
/// child c's weight, its stored normal and its turned normal; children of weight 0 may be skipped.
template <bool by_view, class Each>
GB_HD Voxel filter_children(const Voxel children[8], const Weights& weights, MipFilter filter, const Tables& tables,
                            const Each& each) {
  MipSums sums;
  UnitNormal first{{0, 0, 0}};
  GB_UNROLL_ALWAYS
  for (int c = 0; c < 8; ++c) {
    const std::uint32_t w = by_view ? weights.of(c) : children[c].rgba[3];
#if !defined(__CUDA_ARCH__)
    if (w == 0) continue;  // It would add nothing. On a device all lanes run the same code, so the test is omitted.
#endif
    const UnitNormal stored = unit_normal_of(children[c].normal, tables);
    if (sums.weight == 0) first = stored;
    const UnitNormal n{by_view && are_opposite(stored, first) ? stored.c * -1 : stored.c};
    sums.add(children[c], n, w, tables);
    each(c, w, stored, n);
  }
  return sums.voxel(by_view ? weights.max_directional_coverage() : mean_coverage(sums.weight, filter, tables), tables);
}

struct NothingForEach {
  GB_HD void operator()(int, std::uint32_t, const UnitNormal&, const UnitNormal&) const {}
};

template <bool by_view>
GB_HD Voxel filter_children(const Voxel children[8], const Weights& weights, MipFilter filter, const Tables& tables) {
  return filter_children<by_view>(children, weights, filter, tables, NothingForEach{});
}

}  // namespace gigabake::kernels
