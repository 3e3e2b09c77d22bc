/// The columns that one snapped triangle may overlap, and the triangle's height range in each.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>

#include "core/math/vec3.h"
#include "core/octree/brick.h"
#include "kernels/body/voxelize/classify_triangle.h"

namespace gigabake {

/// A triangle with vertices in sub-voxels from the lattice origin; |coordinate| ≤ 2^53.
struct LatticeTriangle {
  Vec3i64 p[3];
};

inline bool has_area(const LatticeTriangle& triangle) { return kernels::has_area<__int128>(triangle.p); }

struct ColumnGrid {
  int cell_bits = 10;   ///< log2 of the cell's edge in voxels
  bool closed = false;  ///< true if the surface rule counts contact: voxels are then closed cubes, else half-open
};

/// Inclusive range of voxels along one axis.
struct VoxelSpan {
  std::int64_t first, last;
};

/// Returns the voxels that the triangle's box overlaps along one axis. Uses exact integer arithmetic.
inline VoxelSpan voxel_span(const LatticeTriangle& t, int axis, bool closed) {
  const std::int64_t lo = std::min({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
  const std::int64_t hi = std::max({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
  const std::int64_t first = closed ? lo - 1 : lo, last = closed || lo == hi ? hi : hi - 1;
  return {first >> subvoxel_bits, last >> subvoxel_bits};
}

/// Returns the column indices that a range of voxels overlaps along x or y.
inline VoxelSpan columns_of(VoxelSpan voxels, const ColumnGrid& grid) {
  return {voxels.first >> grid.cell_bits, voxels.last >> grid.cell_bits};
}

/// Returns the column indices that the triangle's box overlaps along x or y.
inline VoxelSpan column_span(const LatticeTriangle& triangle, int axis, const ColumnGrid& grid) {
  return columns_of(voxel_span(triangle, axis, grid.closed), grid);
}

/// Calls visit(column_x, column_y, z range) for every column in which the surface rule may occupy a voxel, and for some
/// neighbours of these columns. The z range contains every voxel that the surface rule may occupy in the column.
/// Returns false if there are more than `max_columns` columns; some may have been visited by then.
/// Exact   The result is conservative, and exact for a triangle inside one column. Otherwise the triangle is clipped in
///         double to each column grown by one sub-voxel and 2^-48 of the triangle's extent. The error of a clipped
///         coordinate is below 2^-49 of that extent.
/// Cost    Proportional to the rows of columns of the bounding box plus the visited columns, not to all columns of the
///         box.
bool for_each_column(const LatticeTriangle& triangle, const ColumnGrid& grid, std::uint64_t max_columns,
                     const std::function<void(std::int64_t, std::int64_t, VoxelSpan)>& visit);

}  // namespace gigabake
