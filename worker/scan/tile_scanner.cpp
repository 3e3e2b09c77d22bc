#include "worker/scan/tile_scanner.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "kernels/body/voxelize/part.h"
#include "worker/pipeline/lattice.h"
#include "worker/scan/instance_bounds.h"
#include "worker/scan/long_triangles.h"

namespace gigabake {
namespace {

constexpr std::size_t triangles_per_range = 16384, vertices_per_range = 65536, clusters_per_range = 4;
/// Thresholds above which a primitive is scanned by the boxes of its placements.
constexpr std::size_t min_boxed_instances = 16;
constexpr std::uint64_t max_exact_triangles = std::uint64_t(1) << 20;
constexpr double max_projected_voxels = 0x1p60;  ///< of one triangle or box
constexpr double max_voxel = 0x1p44;             ///< half of the range of snap(): ±2^45 voxels

/// Returns the unsnapped scene position of a vertex; it may be infinite.
Vec3d scene_position(const Primitive& primitive, std::uint32_t vertex, const Instance& instance) {
  const Vec3d local = Vec3d::from(primitive.position.data() + 3 * std::size_t(vertex));
  return Vec3d::by_axis([&](std::size_t row) {
    const auto& m = instance.scene_from_local.m[row];
    return dot(Vec3d::from(m), local) + m[3];
  });
}

/// Returns the longest side, in metres, of the box of an unsnapped triangle; infinite if a vertex is not finite.
double side_m(const Primitive& primitive, const std::uint32_t* index, const Instance& instance) {
  const std::array<Vec3d, 3> p_m = {scene_position(primitive, index[0], instance),
                                    scene_position(primitive, index[1], instance),
                                    scene_position(primitive, index[2], instance)};
  double side = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!std::isfinite(p_m[0][c] + p_m[1][c] + p_m[2][c])) return HUGE_VAL;
    const auto [low, high] = std::minmax({p_m[0][c], p_m[1][c], p_m[2][c]});
    side = std::max(side, high - low);
  }
  return side;
}

/// Returns twice the sum of a triangle's areas projected along x, y and z. `a` and `b` are two of its edges. The result
/// is exact for lattice triangles while the values fit into a double.
double doubled_views(const Vec3d& a, const Vec3d& b) { return sum_of_magnitudes(cross(a, b)); }

std::uint64_t projected_voxels_of(const LatticeTriangle& t, int lod) {
  const double views = doubled_views(Vec3d(t.p[1] - t.p[0]), Vec3d(t.p[2] - t.p[0]));
  return std::uint64_t(std::min(std::ldexp(views, -2 * lod), max_projected_voxels));
}

/// Returns the area of the primitive's finite triangles in its local frame.
double area_m2(const Primitive& primitive) {
  double doubled = 0;
  for (std::size_t t = 0; t + 2 < primitive.index.size(); t += 3) {
    const auto corner = [&](std::size_t i) {
      return Vec3d::from(primitive.position.data() + 3 * std::size_t(primitive.index[t + i]));
    };
    const double area = length(cross(corner(1) - corner(0), corner(2) - corner(0)));
    if (std::isfinite(area)) doubled += area;
  }
  return doubled / 2;
}

/// Returns the factor by which a placement scales areas; it is exact for uniform scales.
double area_scale(const Instance& instance) {
  return std::pow(std::fabs(kernels::determinant(row_major(instance.scene_from_local).data())), 2.0 / 3);
}

std::uint64_t triangles_not_finite(const Primitive& primitive) {
  const auto is_finite = [&](std::uint32_t vertex) {
    const float* p = primitive.position.data() + 3 * std::size_t(vertex);
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
  };
  std::uint64_t count = 0;
  for (std::size_t t = 0; t + 2 < primitive.index.size(); t += 3)
    count += !std::all_of(&primitive.index[t], &primitive.index[t] + 3, is_finite);
  return count;
}

bool is_boxed(std::uint64_t triangles, std::size_t placements) {
  return placements >= min_boxed_instances && placements * triangles > max_exact_triangles;
}

/// Extends `extent` by the vertices on the lattice; a triangle with any other vertex is dropped.
template <class Vertices>
void widen(CoordinateRange& extent, const Primitive& mesh, const Vertices& vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t axis = 0; vertices[i].valid && axis < 3; ++axis)
      extent[axis] = std::max(extent[axis], std::fabs(mesh.position[3 * i + axis]));
}

Box3i64 box_of(const std::array<VoxelSpan, 3>& voxels) {
  return {{voxels[0].first, voxels[1].first, voxels[2].first},
          {voxels[0].last + 1, voxels[1].last + 1, voxels[2].last + 1}};
}

bool is_one(VoxelSpan columns) { return columns.first == columns.last; }

}  // namespace

TileScanner::TileScanner(const TileRef& tile, const BakeParameters& parameters, const ThreadPool& pool)
    : tile_(tile),
      parameters_(parameters),
      pool_(pool),
      grid_{int(std::bit_width(parameters.cell_voxels)) - 1, parameters.surface != SurfaceRule::area},
      threads_(std::size_t(pool.threads())) {}

void TileScanner::add(const Primitive& mesh, Placements placements) {
  if (is_boxed(mesh.index.size() / 3, placements.size())) return add_boxes(mesh, placements);
  for (const Instance* instance : placements) add_placed(mesh, *instance);
}

void TileScanner::add(const LoadedTile& tile, std::size_t primitive, Placements placements) {
  const TilePrimitive& cut = tile.primitives()[primitive];
  if (placements.empty()) return;
  if (cut.clusters.size() < 2 || is_boxed(cut.triangles, placements.size()))
    return add(*tile.whole(primitive), placements);
  for (ThreadScan& thread : threads_) thread.extent.assign(placements.size(), {});
  pool_.parallel_for(cut.clusters.size(), clusters_per_range, [&](std::size_t begin, std::size_t end, int thread) {
    for (std::size_t i = begin; i < end; ++i)
      add_cluster(*tile.mesh_of({&cut.clusters[i]}), placements, threads_[std::size_t(thread)]);
  });
  for (std::size_t i = 0; i < placements.size(); ++i) {
    CoordinateRange extent{};
    for (const ThreadScan& thread : threads_) extent = max_by_axis(extent, thread.extent[i]);
    spacing_m_ =
        std::max(spacing_m_, coordinate_resolution_m(tile.mesh().primitives[primitive], *placements[i], extent));
  }
}

void TileScanner::finish(TileScan& scan) const {
  scan.spacing_m = spacing_m_;
  for (const ThreadScan& thread : threads_) {
    scan.non_finite += thread.non_finite;
    scan.zero_area += thread.zero_area;
    scan.too_far += thread.too_far;
    scan.reach_m = std::max(scan.reach_m, thread.reach_m);
    scan.bounds = hull(scan.bounds, thread.bounds);
    for (const auto& [key, column] : thread.map.columns()) scan.columns.push_back(column);
  }
  unite_columns(scan.columns);
}

void TileScanner::snap(const Primitive& mesh, const Instance& instance, std::span<SnappedVertex> out,
                       std::size_t first) const {
  const SnapFrame frame = snap_frame(parameters_);
  const auto scene_from_local = row_major(instance.scene_from_local);
  const int lod = lod_of(instance, tile_);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i].valid = snap_to_level(frame, scene_from_local.data(), mesh.position.data() + 3 * (first + i), lod, out[i].p);
}

void TileScanner::add_placed(const Primitive& mesh, const Instance& instance) {
  vertices_.resize(mesh.position.size() / 3);
  const std::span<SnappedVertex> vertices(vertices_);
  pool_.parallel_for(vertices.size(), vertices_per_range, [&](std::size_t begin, std::size_t end, int) {
    snap(mesh, instance, vertices.subspan(begin, end - begin), begin);
  });
  CoordinateRange extent{};
  widen(extent, mesh, vertices);
  spacing_m_ = std::max(spacing_m_, coordinate_resolution_m(mesh, instance, extent));
  const std::span<const std::uint32_t> corners(mesh.index);
  pool_.parallel_for(corners.size() / 3, triangles_per_range, [&](std::size_t begin, std::size_t end, int thread) {
    add_triangles(mesh, corners.subspan(3 * begin, 3 * (end - begin)), vertices, instance,
                  threads_[std::size_t(thread)]);
  });
}

void TileScanner::add_cluster(const Primitive& cluster, Placements placements, ThreadScan& found) const {
  found.vertices.resize(cluster.position.size() / 3);
  for (std::size_t i = 0; i < placements.size(); ++i) {
    snap(cluster, *placements[i], found.vertices, 0);
    widen(found.extent[i], cluster, found.vertices);
    add_triangles(cluster, cluster.index, found.vertices, *placements[i], found);
  }
}

/// Scans all placements by their boxes; unlike add_placed(), does not count triangles without area. A placement is
/// scanned triangle by triangle if its box is beyond the lattice or may hold a triangle that is too long, because its
/// other triangles may be valid.
void TileScanner::add_boxes(const Primitive& mesh, Placements placements) {
  const LocalBounds bounds = bounds_of(mesh);
  const std::uint64_t triangles = mesh.index.size() / 3, non_finite = triangles_not_finite(mesh);
  const double local_area_m2 = area_m2(mesh);
  std::vector<char> is_far(placements.size(), 0);
  pool_.parallel_for(placements.size(), 1024, [&](std::size_t begin, std::size_t end, int thread) {
    ThreadScan& found = threads_[std::size_t(thread)];
    for (std::size_t i = begin; i < end; ++i) {
      const SceneBox box = scene_box(bounds, *placements[i], parameters_);
      const std::uint64_t projected_voxels =
          projected_voxels_of_area(local_area_m2 * area_scale(*placements[i]), lod_of(*placements[i], tile_));
      is_far[i] = may_have_long_triangle(box, parameters_) ||
                  (!box.is_empty() && !add_box(box, triangles, projected_voxels, found));
      if (is_far[i] == 0) found.non_finite += non_finite;
    }
  });
  for (std::size_t i = 0; i < placements.size(); ++i)
    if (is_far[i] != 0) add_placed(mesh, *placements[i]);
}

/// Returns the projected voxels of an area with evenly distributed normals, times projected_voxel_unit. The mean of |x|
/// + |y| + |z| over all unit normals (x, y, z) is 3/2.
std::uint64_t TileScanner::projected_voxels_of_area(double surface_m2, int lod) const {
  const double voxel_m = std::ldexp(parameters_.voxel_size_m, lod), voxels = 1.5 * surface_m2 / (voxel_m * voxel_m);
  return std::uint64_t(std::clamp(voxels * projected_voxel_unit, 0.0, max_projected_voxels));
}

/// Returns false and adds nothing if the box extends beyond the lattice.
bool TileScanner::add_box(const SceneBox& box, std::uint64_t triangles, std::uint64_t projected_voxels,
                          ThreadScan& found) const {
  std::array<VoxelSpan, 3> voxels;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto voxel = [&](double p_m) {
      return std::floor((p_m - parameters_.lattice_origin_m[c]) / parameters_.voxel_size_m);
    };
    const double first = voxel(box.low_m[c]), last = voxel(box.high_m[c]);
    if (!(first > -max_voxel && last < max_voxel)) return false;
    voxels[c] = {std::int64_t(first), std::int64_t(last)};
  }
  const VoxelSpan x = columns_of(voxels[0], grid_), y = columns_of(voxels[1], grid_);
  if (std::uint64_t(x.last - x.first) >= max_columns || std::uint64_t(y.last - y.first) >= max_columns) refuse();
  const std::uint64_t share =
      projected_voxels / (std::uint64_t(x.last - x.first + 1) * std::uint64_t(y.last - y.first + 1));
  for (std::int64_t row = y.first; row <= y.last; ++row)
    for (std::int64_t column = x.first; column <= x.last; ++column) {
      found.map.add({column, row, voxels[2].first, voxels[2].last + 1, triangles, share});
      if (found.map.is_too_wide()) refuse();
    }
  found.bounds = hull(found.bounds, box_of(voxels));
  return true;
}

void TileScanner::refuse() const {
  throw InputError(tile_.path, "",
                   "its triangles cover more than " + std::to_string(max_columns) + " columns of " +
                       std::to_string(parameters_.cell_voxels) +
                       " voxels; enlarge `voxel_size_m` or `cell_voxels`, or check the unit of its coordinates");
}

void TileScanner::add_triangles(const Primitive& mesh, std::span<const std::uint32_t> corners,
                                std::span<const SnappedVertex> vertices, const Instance& instance,
                                ThreadScan& found) const {
  const int lod = lod_of(instance, tile_);
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
    LatticeTriangle triangle;
    bool is_on_lattice = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const SnappedVertex& v = vertices[corners[t + i]];
      is_on_lattice = is_on_lattice && v.valid;
      triangle.p[i] = v.p.v;
    }
    if (is_on_lattice) {
      add_triangle(triangle, lod, found);
    } else if (const double side = side_m(mesh, &corners[t], instance); std::isfinite(side)) {
      ++found.too_far;
      found.reach_m = std::max(found.reach_m, side);
    } else {
      ++found.non_finite;
    }
  }
}

void TileScanner::add_triangle(const LatticeTriangle& triangle, int lod, ThreadScan& found) const {
  const std::int64_t side = side_of(triangle);
  const bool is_far = side > max_triangle_side;
  // Products of differences up to max_triangle_side fit into 64 bits.
  if (!(is_far ? has_area(triangle) : kernels::has_area<std::int64_t>(triangle.p))) {
    ++found.zero_area;
    return;
  }
  if (is_far) {
    ++found.too_far;
    found.reach_m = std::max(found.reach_m, double(side) / double(subvoxels) * parameters_.voxel_size_m);
    return;
  }
  const std::array<VoxelSpan, 3> voxels = {voxel_span(triangle, 0, grid_.closed), voxel_span(triangle, 1, grid_.closed),
                                           voxel_span(triangle, 2, grid_.closed)};
  found.bounds = hull(found.bounds, box_of(voxels));
  const VoxelSpan x = columns_of(voxels[0], grid_), y = columns_of(voxels[1], grid_), z = voxels[2];
  if (is_one(x) && is_one(y)) {
    found.map.add({x.first, y.first, z.first, z.last + 1, 1, projected_voxels_of(triangle, lod)});
  } else {
    add_wide(triangle, projected_voxels_of(triangle, lod), found);
  }
  if (found.map.is_too_wide()) refuse();
}

void TileScanner::add_wide(const LatticeTriangle& triangle, std::uint64_t projected_voxels, ThreadScan& found) const {
  found.touched.clear();
  const bool fits = for_each_column(triangle, grid_, max_columns, [&](std::int64_t x, std::int64_t y, VoxelSpan z) {
    found.touched.push_back({x, y, z.first, z.last + 1, 1});
  });
  if (!fits) refuse();
  for (ColumnExtent& column : found.touched) {
    column.projected_voxels = projected_voxels / found.touched.size();
    found.map.add(column);
  }
}

}  // namespace gigabake
