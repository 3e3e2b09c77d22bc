#include "worker/scan/column_span.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/host_device.h"

namespace gigabake {
namespace {

/// A convex polygon, in sub-voxels from the triangle's first vertex. A triangle clipped by four half-spaces has at most
/// 7 vertices.
struct Polygon {
  std::array<Vec3d, 8> p;
  int count = 0;
  void add(const Vec3d& v) { p[std::size_t(count++)] = v; }
};

struct Range {
  double low, high;
};

Range range_of(const Polygon& polygon, int axis) {
  Range r{polygon.p[0][std::size_t(axis)], polygon.p[0][std::size_t(axis)]};
  for (int i = 1; i < polygon.count; ++i) {
    r.low = std::min(r.low, polygon.p[std::size_t(i)][std::size_t(axis)]);
    r.high = std::max(r.high, polygon.p[std::size_t(i)][std::size_t(axis)]);
  }
  return r;
}

/// Clips the polygon to the half-space sign · p[axis] ≤ sign · bound, where `sign` is 1 or -1.
Polygon cut(const Polygon& in, std::size_t axis, double bound, double sign) {
  Polygon out;
  for (int i = 0; i < in.count; ++i) {
    const auto& a = in.p[std::size_t(i)];
    const auto& b = in.p[std::size_t(i + 1 == in.count ? 0 : i + 1)];
    const double beyond_a = sign * (a[axis] - bound), beyond_b = sign * (b[axis] - bound);
    if (beyond_a <= 0) out.add(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
      const double share = (bound - a[axis]) / (b[axis] - a[axis]);
      Vec3d v = a + (b - a) * share;
      v[axis] = bound;
      out.add(v);
    }
  }
  return out;
}

Polygon cut(const Polygon& in, std::size_t axis, Range range) {
  const Polygon half = cut(in, axis, range.high, 1);
  return half.count == 0 ? half : cut(half, axis, range.low, -1);
}

/// A triangle that spans several columns.
class WideTriangle {
 public:
  WideTriangle(const LatticeTriangle& triangle, const ColumnGrid& grid)
      : t_(triangle), bits_(grid.cell_bits + subvoxel_bits), z_(voxel_span(triangle, 2, grid.closed)) {
    double extent = 0;
    for (const Vec3i64& p : t_.p) {
      const Vec3d v(p - t_.p[0]);
      for (const double coordinate : v) extent = std::max(extent, std::fabs(coordinate));
      whole_.add(v);
    }
    margin_ = 1 + std::ldexp(extent, -48);
  }

  Polygon row(std::int64_t row) const { return cut(whole_, 1, column_range(row, 1)); }

  VoxelSpan columns_of(const Polygon& row) const {
    const Range x = range_of(row, 0);
    return {lattice_floor(x.low - margin_, 0) >> bits_, lattice_floor(x.high + margin_, 0) >> bits_};
  }

  /// Returns the triangle's range of voxels along z in a column; empty (first > last) if the triangle misses the
  /// column.
  VoxelSpan height(const Polygon& row, std::int64_t column) const {
    const Polygon part = cut(row, 0, column_range(column, 0));
    if (part.count == 0) return {1, 0};
    const Range z = range_of(part, 2);
    return {std::max(z_.first, lattice_floor(z.low - margin_, 2) >> subvoxel_bits),
            std::min(z_.last, lattice_floor(z.high + margin_, 2) >> subvoxel_bits)};
  }

 private:
  Range column_range(std::int64_t column, int axis) const {
    const std::int64_t edge = std::int64_t(1) << bits_, low = column * edge - t_.p[0][axis];
    return {double(low) - margin_, double(low + edge) + margin_};
  }
  std::int64_t lattice_floor(double coordinate, int axis) const {
    return std::int64_t(std::floor(coordinate)) + t_.p[0][axis];
  }

  const LatticeTriangle& t_;
  int bits_;
  VoxelSpan z_;
  Polygon whole_;
  double margin_ = 1;
};

}  // namespace

bool for_each_column(const LatticeTriangle& triangle, const ColumnGrid& grid, std::uint64_t max_columns,
                     const std::function<void(std::int64_t, std::int64_t, VoxelSpan)>& visit) {
  const VoxelSpan x = column_span(triangle, 0, grid), y = column_span(triangle, 1, grid);
  if (x.first == x.last && y.first == y.last) {
    visit(x.first, y.first, voxel_span(triangle, 2, grid.closed));
    return true;
  }
  if (std::uint64_t(y.last - y.first) >= max_columns) return false;
  const WideTriangle wide(triangle, grid);
  std::uint64_t visited = 0;
  for (std::int64_t row = y.first; row <= y.last; ++row) {
    const Polygon part = wide.row(row);
    if (part.count == 0) continue;
    const VoxelSpan reach = wide.columns_of(part);
    const std::int64_t first = std::max(x.first, reach.first), last = std::min(x.last, reach.last);
    visited += std::uint64_t(std::max<std::int64_t>(0, last - first + 1));
    if (visited > max_columns) return false;
    for (std::int64_t column = first; column <= last; ++column) {
      const VoxelSpan z = wide.height(part, column);
      if (z.first <= z.last) visit(column, row, z);
    }
  }
  return true;
}

}  // namespace gigabake
