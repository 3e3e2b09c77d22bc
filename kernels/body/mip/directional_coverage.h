/// Directional coverage of a coarser voxel and visibility of each of its children, seen along the axes.
///
/// A voxel's *raster* is its coverage mask along x, y and z: its content projected onto the face across each axis. The
/// cells of a raster have values 0…255. Per axis, a raster has one cell at lod 0 (AxisCoverage), 2×2 at lod 1, 4×4 at
/// lod 2 and 8×8 at coarser lods. At lod 4 and coarser lods, a cell is the mean of four finer cells. A child occludes
/// the child behind it cell by cell. Coverage is therefore exact for opaque voxels up to lod 3. At coarser lods, two
/// surfaces are distinguished if they are an eighth of a voxel apart. A single value per axis does not suffice: two
/// half-covered children behind each other may cover half of their parent's face, or all of it.
///
/// Exact   Integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/downsample_state.h"
#include "kernels/body/voxelize/axis_coverage.h"

namespace gigabake::kernels {

/// Returns the size of a raster with edge² cells per axis, in 32-bit words. A word holds four cells, the first in the
/// lowest byte. The cells along x come first, then y, then z. Cell (u, v) of an axis has index u + edge·v. The axes of
/// u and v are the other two axes, in the order x, y, z.
/// Range   edge ≥ 2.
GB_HD constexpr int raster_words(int edge) { return 3 * edge * edge / 4; }

/// Returns x/255, rounded to nearest.
/// Range   x ≤ 255².
GB_HD std::uint32_t over_255(std::uint32_t x) {
  x += 128;
  return (x + (x >> 8)) >> 8;
}

/// Returns the union of the coverages of four cells, one byte per cell: a + b - ab/255, rounded to nearest.
GB_HD std::uint32_t cover_4(std::uint32_t a, std::uint32_t b) {
  constexpr std::uint32_t bytes = 0x00ff00ff, half = 0x00800080;
  const std::uint32_t p = ~a, q = ~b;  // uncovered fraction: (255-a)(255-b)/255
  std::uint32_t even = (p & 255) * (q & 255) + (p >> 16 & 255) * (q & 0xff0000) + half;
  std::uint32_t odd = (p >> 8 & 255) * (q >> 8 & 255) + (p >> 24) * (q >> 8 & 0xff0000) + half;
  even += even >> 8 & bytes;
  odd += odd >> 8 & bytes;
  return ~((even >> 8 & bytes) | (odd & ~bytes));
}

GB_HD std::uint32_t sum_4(std::uint32_t cells) {
#if defined(__CUDA_ARCH__)
  return __dp4a(cells, 0x01010101u, 0u);
#else
  return ((cells & 0x00ff00ff) + (cells >> 8 & 0x00ff00ff)) * 0x10001u >> 16;
#endif
}

/// Run of 4·N adjacent cells of a raster along one axis. N = 1 holds all cells of a 2×2 raster. N = 4 holds all cells
/// of a 4×4 raster or two rows of an 8×8 raster.
template <int N>
struct alignas(4 * N) CellRun {
  std::uint32_t word[N];
};

/// Returns the union of two coverages per cell, and adds the sums of `low`, of `high` and of the union to `sums`. On a
/// device four cells are combined at once in a 32-bit word. On a host the loop runs over single cells, because
/// compilers turn that loop into vector instructions.
template <int N>
GB_HD CellRun<N> cover(const CellRun<N>& low, const CellRun<N>& high, std::uint32_t sums[3]) {
  CellRun<N> either;
#if defined(__CUDA_ARCH__)
  GB_UNROLL_ALWAYS
  for (int w = 0; w < N; ++w) {
    either.word[w] = cover_4(low.word[w], high.word[w]);
    sums[0] += sum_4(low.word[w]);
    sums[1] += sum_4(high.word[w]);
    sums[2] += sum_4(either.word[w]);
  }
#else
  const auto *a = reinterpret_cast<const std::uint8_t*>(low.word),
             *b = reinterpret_cast<const std::uint8_t*>(high.word);
  auto* both = reinterpret_cast<std::uint8_t*>(either.word);
  for (int i = 0; i < 4 * N; ++i) {
    both[i] = std::uint8_t(a[i] + b[i] - over_255(std::uint32_t(a[i]) * b[i]));
    sums[0] += a[i];
    sums[1] += b[i];
    sums[2] += both[i];
  }
#endif
  return either;
}

/// Returns the lower child of a column (0…3) along an axis. A column is a pair of children that lie behind each other
/// along the axis. The upper child is low | 1 << axis.
GB_HD constexpr int low_child(int axis, int column) {
  return (column & ((1 << axis) - 1)) | (column >> axis) << (axis + 1);
}

/// Sums over the cells of all added columns.
struct CoverageSums {
  std::uint32_t covered[3] = {};
  std::uint32_t seen[8] = {};  ///< visible coverage of each child, summed over the views from six sides

  GB_HD void add(int axis, int column, const std::uint32_t sums[3]) {
    const int low = low_child(axis, column), high = low | 1 << axis;
    covered[axis] += sums[2];
    seen[low] += sums[0] + sums[2] - sums[1];
    seen[high] += sums[1] + sums[2] - sums[0];
  }

  /// Returns the directional coverage, 1…255. It is not 0, so that an existing voxel does not vanish. `edge` is the
  /// edge of the children's rasters in cells.
  GB_HD std::uint8_t directional_coverage(int axis, int edge) const {
    const std::uint32_t cells = 4 * std::uint32_t(edge * edge), mean = (covered[axis] + cells / 2) / cells;
    return std::uint8_t(mean < 1 ? 1 : mean);
  }
  /// Returns the visible fraction of a child, 0…255; 0 only if nothing of it is visible.
  GB_HD std::uint32_t weight(int child, int edge) const {
    const std::uint32_t cells = 6 * std::uint32_t(edge * edge);
    return (seen[child] + cells - 1) / cells;
  }
};

/// Number of words per run. Edge is the edge of the children's rasters in cells: 2, 4 or 8. The parent's raster has
/// edge min(2·Edge, 8).
template <int Edge>
inline constexpr int run_words = Edge == 2 ? 1 : 4;
template <int Edge>
inline constexpr int runs_per_column = Edge* Edge / 4 / run_words<Edge>;

/// Returns the means of two blocks of 2×2 cells from two rows of four cells. Bytes 0 and 2 of the result are the means.
GB_HD std::uint32_t means_of(std::uint32_t upper, std::uint32_t lower) {
  constexpr std::uint32_t bytes = 0x00ff00ff;
  return ((upper & bytes) + (upper >> 8 & bytes) + (lower & bytes) + (lower >> 8 & bytes) + 0x00020002) >> 2 & bytes;
}

/// Returns bytes 0 and 2 of `a`, followed by bytes 0 and 2 of `b`.
GB_HD std::uint32_t even_bytes(std::uint32_t a, std::uint32_t b) {
  return (a & 0xff) | (a >> 8 & 0xff00) | (b << 16 & 0xff0000) | (b << 8 & 0xff000000);
}

/// Adds one run of a column of children to the parent's raster. The sums over the lower child, the upper child and
/// their union are added to `sums`. The call children.cells<4>(child, axis, run) returns a run of a child's raster, or
/// zeros if the child does not exist.
/// Range   Edge is 4 or 8.
template <int Edge, class Children>
GB_HD void see_run(const Children& children, int axis, int column, int run, std::uint32_t* raster,
                   std::uint32_t sums[3]) {
  const int low = low_child(axis, column), high = low | 1 << axis;
  const CellRun<4> either =
      cover(children.template cells<4>(low, axis, run), children.template cells<4>(high, axis, run), sums);
  std::uint32_t* to = raster + 16 * axis + 8 * (column >> 1) + (column & 1);  // two words per row
  if constexpr (Edge == 4) {
    GB_UNROLL_ALWAYS
    for (int row = 0; row < 4; ++row) to[2 * row] = either.word[row];
  } else {
    to[2 * run] = even_bytes(means_of(either.word[0], either.word[2]), means_of(either.word[1], either.word[3]));
  }
}

/// Computes the parent's raster from children with 2×2 cells per axis and returns the sums.
template <class Children>
GB_HD CoverageSums see_small(const Children& children, std::uint32_t* raster) {
  CoverageSums result;
  GB_UNROLL_ALWAYS
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t either[4];
    GB_UNROLL_ALWAYS
    for (int column = 0; column < 4; ++column) {
      const int low = low_child(axis, column), high = low | 1 << axis;
      std::uint32_t sums[3] = {};
      either[column] =
          cover(children.template cells<1>(low, axis, 0), children.template cells<1>(high, axis, 0), sums).word[0];
      result.add(axis, column, sums);
    }
    GB_UNROLL_ALWAYS
    for (int half = 0; half < 4; half += 2) {  // two adjacent columns form two rows
      raster[4 * axis + half] = (either[half] & 0xffff) | either[half + 1] << 16;
      raster[4 * axis + half + 1] = either[half] >> 16 | (either[half + 1] & 0xffff0000);
    }
  }
  return result;
}

/// Computes the parent's raster and returns the sums over its children. All words of `raster` are overwritten.
template <int Edge, class Children>
GB_HD CoverageSums cover_children(const Children& children, std::uint32_t* raster) {
  if constexpr (Edge == 2) {
    return see_small(children, raster);
  } else {
    CoverageSums result;
    for (int axis = 0; axis < 3; ++axis)
      for (int column = 0; column < 4; ++column) {
        std::uint32_t sums[3] = {};
        for (int run = 0; run < runs_per_column<Edge>; ++run) see_run<Edge>(children, axis, column, run, raster, sums);
        result.add(axis, column, sums);
      }
    return result;
  }
}

/// Computes the raster of the parent of eight lod-0 voxels and returns the sums. The raster of a lod-0 voxel is its
/// axis coverage.
GB_HD CoverageSums see_voxels(const AxisCoverage& c, std::uint32_t raster[3]) {
  const std::uint32_t *x = c.along[0], *y = c.along[1], *z = c.along[2];
  const std::uint32_t low[3] = {even_bytes(x[0], x[1]), (y[0] & 0xffff) | y[1] << 16, z[0]};
  const std::uint32_t high[3] = {even_bytes(x[0] >> 8, x[1] >> 8), y[0] >> 16 | (y[1] & 0xffff0000), z[1]};
  CoverageSums result;
  GB_UNROLL_ALWAYS
  for (int axis = 0; axis < 3; ++axis) {
    raster[axis] = cover_4(low[axis], high[axis]);
    GB_UNROLL_ALWAYS
    for (int column = 0; column < 4; ++column) {
      const int at = 8 * column;
      const std::uint32_t sums[3] = {low[axis] >> at & 255, high[axis] >> at & 255, raster[axis] >> at & 255};
      result.add(axis, column, sums);
    }
  }
  return result;
}

}  // namespace gigabake::kernels
