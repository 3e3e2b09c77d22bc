/// What views along the axes see of a coarser voxel, and of each of its children.
///
/// A voxel's *raster* is what it shows along x, y and z: its content projected onto the face across each axis, in cells
/// of 0…255: one cell at lod 0 (its coverage), 2×2 at lod 1, 4×4, and 8×8 from lod 3 on, where a cell is the mean of
/// four. Children one behind the other hide each other cell by cell. So coverage is exact for opaque voxels up to lod
/// 3, and beyond it two sheets are mistaken for each other only within an eighth of a voxel. Coverage alone cannot
/// know: half of a voxel behind half of a voxel hides nothing of what is behind both, or all of it.
///
/// Exact   Integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "kernels/types.h"

namespace gigabake::kernels {

inline constexpr int most_raster_edge = 8;
/// Cells along an edge of a raster.
GB_HD constexpr int raster_edge(int lod) { return lod < 3 ? 1 << lod : most_raster_edge; }
/// Of the three axes' cells. Cell (u, v) of an axis, u along the lower of the other two, is u + edge·v.
GB_HD constexpr int raster_bytes(int edge) { return 3 * edge * edge; }

/// x/255, to the nearest. Range  x ≤ 255².
GB_HD std::uint32_t over_255(std::uint32_t x) {
  x += 128;
  return (x + (x >> 8)) >> 8;
}

/// Cells of a raster that stand side by side. Of a column N = 1, 4 or 16: two rows of an 8×8 raster, else all of it.
template <int N>
struct CellRun {
  alignas(N) std::uint8_t cell[N];
};

/// What is covered by either, and the sums of all three.
template <int N>
GB_HD void cover(const CellRun<N>& low, const CellRun<N>& high, CellRun<N>& either, std::uint32_t sums[3]) {
  GB_UNROLL
  for (int i = 0; i < N; ++i) {
    const std::uint32_t a = low.cell[i], b = high.cell[i], both = a + b - over_255(a * b);
    either.cell[i] = std::uint8_t(both);
    sums[0] += a;
    sums[1] += b;
    sums[2] += both;
  }
}

/// The voxel's children as its column `column` (0…3) along an axis: the one on the lower side. The other one is
/// low | 1 << axis.
GB_HD constexpr int low_child(int axis, int column) {
  return (column & ((1 << axis) - 1)) | (column >> axis) << (axis + 1);
}

/// Sums over the cells of all columns that were added.
struct FacingSums {
  std::uint32_t covered[3] = {};
  std::uint32_t seen[8] = {};  ///< of each child, from the six sides

  GB_HD void add(int axis, int column, const std::uint32_t sums[3]) {
    const int low = low_child(axis, column), high = low | 1 << axis;
    covered[axis] += sums[2];
    seen[low] += sums[0] + sums[2] - sums[1];
    seen[high] += sums[1] + sums[2] - sums[0];
  }

  /// 1…255: what exists does not vanish. edge: of the children's rasters.
  GB_HD std::uint8_t facing(int axis, int edge) const {
    const std::uint32_t cells = 4 * std::uint32_t(edge * edge), mean = (covered[axis] + cells / 2) / cells;
    return std::uint8_t(mean < 1 ? 1 : mean);
  }
  /// How much of a child shows, of 255; 0 only where nothing does.
  GB_HD std::uint32_t weight(int child, int edge) const {
    const std::uint32_t cells = 6 * std::uint32_t(edge * edge);
    return (seen[child] + cells - 1) / cells;
  }
};

template <int Edge>
inline constexpr int run_cells = Edge < 4 ? Edge* Edge : 16;
template <int Edge>
inline constexpr int runs_per_column = Edge* Edge / run_cells<Edge>;

/// The rows of the parent's raster that a run of a column's cells becomes. Edge: of the children's rasters; the
/// parent's has edge 2·Edge, or 8.
template <int Edge>
struct RasterRows {
  static constexpr int width = Edge < most_raster_edge ? Edge : most_raster_edge / 2;
  static constexpr int stride = 2 * width, rows = Edge < most_raster_edge ? Edge : 1;

  /// Where the first row begins. run: which one of the column.
  GB_HD static int first(int axis, int column, int run) {
    return axis * stride * stride + width * (column & 1) + stride * (width * (column >> 1) + run);
  }
};

/// At once where a device can. Range  to: a multiple of N from a raster's beginning.
template <int N>
GB_HD void store_cells(const CellRun<N>& run, std::uint8_t* to) {
#if defined(__CUDA_ARCH__)
  *reinterpret_cast<CellRun<N>*>(to) = run;
#else
  for (int i = 0; i < N; ++i) to[i] = run.cell[i];
#endif
}

/// Puts a run of covered cells where it belongs in the parent's raster.
template <int Edge>
GB_HD void put(const CellRun<run_cells<Edge>>& run, std::uint8_t* to) {
  using Rows = RasterRows<Edge>;
  GB_UNROLL
  for (int row = 0; row < Rows::rows; ++row) {
    CellRun<Rows::width> cells;
    GB_UNROLL
    for (int i = 0; i < Rows::width; ++i) {
      if constexpr (Edge < most_raster_edge)
        cells.cell[i] = run.cell[i + Edge * row];
      else
        cells.cell[i] =
            std::uint8_t((run.cell[2 * i] + run.cell[2 * i + 1] + run.cell[2 * i + 8] + run.cell[2 * i + 9] + 2u) / 4);
    }
    store_cells(cells, to + Rows::stride * row);
  }
}

/// One run of a column of children, into the parent's raster and the sums.
/// children: gives run `run` of an axis of a child's raster; zeros where there is none.
template <int Edge, class Children>
GB_HD void see_run(const Children& children, int axis, int column, int run, std::uint8_t* raster, FacingSums& out) {
  const int low = low_child(axis, column), high = low | 1 << axis;
  std::uint32_t sums[3] = {};
  CellRun<run_cells<Edge>> either;
  cover(children.template cells<run_cells<Edge>>(low, axis, run),
        children.template cells<run_cells<Edge>>(high, axis, run), either, sums);
  put<Edge>(either, raster + RasterRows<Edge>::first(axis, column, run));
  out.add(axis, column, sums);
}

/// raster: the parent's, which is written whole, and aligned to 16 bytes on a device.
template <int Edge, class Children>
GB_HD FacingSums see_children(const Children& children, std::uint8_t* raster) {
  FacingSums result;
  GB_UNROLL
  for (int axis = 0; axis < 3; ++axis) GB_UNROLL
  for (int column = 0; column < 4; ++column)
    for (int run = 0; run < runs_per_column<Edge>; ++run) see_run<Edge>(children, axis, column, run, raster, result);
  return result;
}

}  // namespace gigabake::kernels
