/// Building blocks of the filter kernels: a voxel's children, their visible coverage, and the filtered voxel.
#pragma once

#include <cstdint>

#include "core/base/rules.h"
#include "core/octree/octree.h"
#include "kernels/body/mask.h"
#include "kernels/body/mip/mip.h"
#include "kernels/body/mip/plane_fit.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

constexpr int filter_threads = 128;

/// Voxel arrays in memory, accessed by index.
struct VoxelArrays {
  const std::uint32_t* rgba;
  const std::uint16_t* normal;  ///< null if the level has none
  const SurfaceMoments* patch;  ///< (kernels/body/mip/patch.h); null at lod 0, or if not required
  const std::uint8_t* planes;   ///< directional coverage of lod 0; null at coarser lods, or if lod 0 has no planes
};

/// The 2×2×2 children of a voxel, ordered x | y<<1 | z<<2.
template <class Index>
struct alignas(8 * sizeof(Index) < 16 ? 8 : 16) Children {
  Index at[8];  ///< index in the children's array, or `none`
  static constexpr Index none = Index(-1);
};

/// Returns the children at (2x, 2y) to (2x + 1, 2y + 1) of two adjacent slabs. `low` and `high` are the slabs' words of
/// a brick's mask. `at_low` is the index of the first voxel of `low`; the voxels of `high` follow.
template <class Index>
__device__ Children<Index> children_in(std::uint64_t low, std::uint64_t high, std::uint32_t at_low, int x, int y) {
  Children<Index> children;
#pragma unroll
  for (int dz = 0; dz < 2; ++dz) {
    const std::uint64_t word = dz == 0 ? low : high;
#pragma unroll
    for (int dy = 0; dy < 2; ++dy) {
      const int bit = 2 * x + 8 * (2 * y + dy);
      const auto two = std::uint32_t(word >> bit) & 3;
      const std::uint32_t at = at_low + bits_below(word, bit);
      Index* pair = children.at + 2 * dy + 4 * dz;
      pair[0] = (two & 1) != 0 ? Index(at) : Children<Index>::none;
      pair[1] = (two & 2) != 0 ? Index(at + (two & 1)) : Children<Index>::none;
    }
    at_low += std::uint32_t(bit_count(word));
  }
  return children;
}

/// Access to the children's coverage masks for see_run() (kernels/body/mip/directional_coverage.h); the masks are
/// stored consecutively.
template <int Edge, class Index>
struct ChildRasters {
  const Children<Index>& children;
  const std::uint32_t* rasters;

  template <int N>
  __device__ CellRun<N> cells(int child, int axis, int run) const {
    const Index at = children.at[child];
    if (at == Children<Index>::none) return {};
    return reinterpret_cast<const CellRun<N>*>(
        rasters)[(std::size_t(raster_words(Edge)) * at + axis * Edge * Edge / 4) / N + run];
  }
};

/// Returns the weights of a voxel's children by their visible coverage. Edge is the edge of the children's coverage
/// masks in cells.
template <int Edge, class Index>
__device__ Weights weights_by_view(const CoverageSums& seen, const Children<Index>& children) {
  std::uint32_t there[2] = {};
#pragma unroll
  for (int c = 0; c < 8; ++c) there[c / 4] |= std::uint32_t(children.at[c] != Children<Index>::none) << 8 * (c % 4);
  return weights_of(seen, Edge, there);
}

/// Terms of a voxel's CoverageSums, by axis and column or child. The lanes that process the columns write them, and
/// total() adds them.
struct alignas(8) ColumnSums {
  std::uint16_t covered[3][4];  ///< [axis][column]
  std::uint16_t seen[3][8];     ///< [axis][child]

  __device__ void put(int axis, int column, const std::uint32_t sums[3]) {
    const int low = low_child(axis, column), high = low | 1 << axis;
    covered[axis][column] = std::uint16_t(sums[2]);
    seen[axis][low] = std::uint16_t(sums[0] + sums[2] - sums[1]);
    seen[axis][high] = std::uint16_t(sums[1] + sums[2] - sums[0]);
  }
  __device__ CoverageSums total() const {
    CoverageSums sums;
#pragma unroll
    for (int axis = 0; axis < 3; ++axis) {
#pragma unroll
      for (int column = 0; column < 4; ++column) sums.covered[axis] += covered[axis][column];
#pragma unroll
      for (int child = 0; child < 8; ++child) sums.seen[child] += seen[axis][child];
    }
    return sums;
  }
};

/// Computes the visible coverage of the children of n voxels. The whole block must call it; one lane processes a run of
/// 16 cells. `rasters` are the children's coverage masks, whose edge has Edge (4 or 8) cells. The voxels' coverage
/// masks, with 8×8 cells per axis, are written to `to`.
template <int Edge, class Index>
__device__ void see_columns(const Children<Index>* children, int n, const std::uint32_t* rasters, std::uint32_t* to,
                            ColumnSums* out) {
  constexpr int runs = runs_per_column<Edge>, lanes = 12 * runs, words = raster_words(max_raster_edge);
  for (int first = int(threadIdx.x & ~31u); first < n * lanes; first += filter_threads) {  // all lanes of a warp
                                                                                           // iterate together
    const int i = first + int(threadIdx.x & 31), voxel = i / lanes;
    const int run = i % runs, column = i / runs % 4, axis = (i - voxel * lanes) / (4 * runs);
    std::uint32_t sums[3] = {};
    if (voxel < n)
      see_run<Edge>(ChildRasters<Edge, Index>{children[voxel], rasters}, axis, column, run,
                    to + std::size_t(words) * voxel, sums);
#pragma unroll
    for (int d = 1; d < runs; d *= 2)
#pragma unroll
      for (std::uint32_t& sum : sums) sum += __shfl_xor_sync(~0u, sum, d);
    if (voxel < n && run == 0) out[voxel].put(axis, column, sums);
  }
}

/// A filtered voxel. The lowest byte of `directional_coverage` is the coverage along x.
struct FilteredVoxel {
  std::uint32_t rgba, directional_coverage;
  std::uint16_t normal;
  Plane plane;
  SurfaceMoments patch;
};

/// Filters a voxel from its children. The children's loads are independent of each other. `is_finest` is true if the
/// children are of lod 0.
template <bool by_view, bool is_finest, class Index>
__device__ FilteredVoxel filter_voxel(const VoxelArrays& below, const Children<Index>& children, const Weights& w,
                                      MipFilter filter, const Tables& tables) {
  Voxel voxel[8];
#pragma unroll
  for (int c = 0; c < 8; ++c) {
    const bool there = children.at[c] != Children<Index>::none;
    voxel[c] = unpack_voxel(there ? below.rgba[children.at[c]] : 0,
                            there && below.normal != nullptr ? below.normal[children.at[c]] : std::uint16_t(0));
  }
  if (!by_view || below.normal == nullptr) {
    const Voxel v = filter_children<by_view>(voxel, w, filter, tables);
    return {pack_rgba(v.rgba), w.directional_coverage, pack_normal(v.normal), {}, {}};
  }
  const auto patch = [&](int c, const UnitNormal& n) {
    if (children.at[c] == Children<Index>::none) return SurfaceMoments{};
    if constexpr (!is_finest) return below.patch[children.at[c]];
    const std::size_t at = directional_coverage_bytes * std::size_t(children.at[c]) + directional_coverage_plane;
    return finest_patch(below.planes == nullptr ? std::uint8_t(0) : below.planes[at], n);
  };
  const VoxelPatch made = filter_patches(voxel, patch, w, is_finest, tables);
  const Plane plane = plane_of(made.patch, made.voxel.normal, is_finest);
  return {pack_rgba(made.voxel.rgba), stored_coverage(plane, w.directional_coverage), pack_normal(made.voxel.normal),
          plane, made.patch};
}

/// Output arrays of a level's voxels.
struct VoxelsOut {
  std::uint32_t* rgba;
  std::uint16_t* normal;               ///< null if the level has none
  std::uint8_t* directional_coverage;  ///< null without MipFilter::coverage
  SurfaceMoments* patch;               ///< null without MipFilter::coverage or normals, or if no later launch reads it

  __device__ void put(std::size_t i, const FilteredVoxel& v) const {
    rgba[i] = v.rgba;
    if (normal != nullptr) normal[i] = v.normal;
    if (directional_coverage == nullptr) return;
    std::uint8_t* to = directional_coverage + directional_coverage_bytes * i;
    for (int a = 0; a < 3; ++a) to[a] = byte_of(v.directional_coverage, a);
    to[directional_coverage_plane] = pack_plane(v.plane);
    if (patch != nullptr) patch[i] = v.patch;
  }
};

}  // namespace gigabake::kernels
