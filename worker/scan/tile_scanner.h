/// Accumulates the lattice columns that one tile's triangles cover. Meshes may be added in any order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/math/snap.h"
#include "core/octree/parameters.h"
#include "format/job/tile_scan.h"
#include "format/source/mesh.h"
#include "format/source/source.h"
#include "worker/scan/column_map.h"
#include "worker/scan/column_span.h"
#include "worker/scan/coordinate_resolution.h"
#include "worker/tiles/loaded_tile.h"

namespace gigabake {

/// A scanner of one tile's meshes.
/// Exact   Columns and counts are independent of the split into meshes and of the number of threads.
/// Errors  Every add() throws InputError if the triangles cover more than max_columns columns.
class TileScanner {
 public:
  using Placements = std::span<const Instance* const>;

  TileScanner(const TileRef& tile, const BakeParameters& parameters, const ThreadPool& pool);

  /// Adds a mesh at all its placements. A mesh with many placements and triangles is scanned by the boxes of its
  /// placements (scan_tile.h).
  void add(const Primitive& mesh, Placements placements);
  /// Adds a primitive of a tile cluster by cluster.
  /// Cost    Holds one cluster per thread in memory.
  void add(const LoadedTile& tile, std::size_t primitive, Placements placements);

  void finish(TileScan& scan) const;

 private:
  struct SnappedVertex {
    LatticePoint p;
    bool valid;
  };
  struct ThreadScan {
    ColumnMap map;
    Box3i64 bounds;                       ///< lod-0 voxels that the triangles overlap
    std::vector<ColumnExtent> touched;    ///< columns that the current triangle overlaps
    std::vector<SnappedVertex> vertices;  ///< of the current cluster
    std::vector<CoordinateRange> extent;  ///< per placement of the current primitive
    std::uint64_t non_finite = 0, zero_area = 0, too_far = 0;
    double reach_m = 0;
  };

  void add_placed(const Primitive& mesh, const Instance& instance);
  void add_cluster(const Primitive& cluster, Placements placements, ThreadScan& found) const;
  void add_boxes(const Primitive& mesh, Placements placements);
  bool add_box(const SceneBox& box, std::uint64_t triangles, std::uint64_t projected_voxels, ThreadScan& found) const;
  void add_triangles(const Primitive& mesh, std::span<const std::uint32_t> corners,
                     std::span<const SnappedVertex> vertices, const Instance& instance, ThreadScan& found) const;
  void add_triangle(const LatticeTriangle& triangle, int lod, ThreadScan& found) const;
  void add_wide(const LatticeTriangle& triangle, std::uint64_t projected_voxels, ThreadScan& found) const;
  void snap(const Primitive& mesh, const Instance& instance, std::span<SnappedVertex> out, std::size_t first) const;
  std::uint64_t projected_voxels_of_area(double surface_m2, int lod) const;
  [[noreturn]] void refuse() const;

  const TileRef& tile_;
  const BakeParameters& parameters_;
  const ThreadPool& pool_;
  const ColumnGrid grid_;
  std::vector<ThreadScan> threads_;
  std::vector<SnappedVertex> vertices_;  ///< of the current mesh
  double spacing_m_ = 0;
};

}  // namespace gigabake
