/// Estimate of a bake at one voxel size from sample pieces of the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace gigabake {

/// Result of baking one column of one tile in isolation.
struct BakedPiece {
  std::uint32_t tile = 0;
  double projected_voxels =
      0;  ///< estimated projected lod-0 voxels of the piece's surface (ColumnExtent::projected_voxels)
  std::uint64_t voxels_lod0 = 0, voxels = 0;  ///< voxels: sum over all levels
  std::uint64_t level_bytes = 0, shard_bytes = 0;
  std::uint32_t cells = 0;
  double read_s = 0, kernel_s = 0, write_s = 0;
};

/// Measurements of the sample pieces at one voxel size.
struct BakedSample {
  std::vector<BakedPiece> pieces;  ///< drawn without replacement, with probabilities proportional to crossings
  double wall_s = 0;               ///< wall time; the stages overlap, as in a bake
};

/// The scene that the pieces were drawn from, in voxels of the same size.
struct SampledScene {
  double projected_voxels = 0;
  std::vector<std::uint64_t> tile_triangles;  ///< per tile
  std::uint64_t cells = 0;
  int ranks = 1;  ///< number of ranks, each as fast as the one that baked the pieces
};

struct SizeEstimate {
  std::uint64_t voxels_lod0 = 0, voxels = 0, bytes = 0;
  std::optional<double> bake_s;  ///< seconds without the scan; nullopt if no piece was baked
  double voxels_error = 0;       ///< relative standard error of the voxels
  double share = 0;              ///< fraction of the surface that was baked
};

/// Estimates a bake. If there are no pieces, assumes one lod-0 voxel per projected voxel and two bytes per voxel.
/// Exact   If the pieces are the whole scene, the numbers of voxels are the sums over the pieces. Otherwise the rest is
///         estimated from the mean of the pieces' voxels per projected voxel (Hansen and Hurwitz 1943). A voxel that
///         several tiles occupy counts once per tile.
SizeEstimate estimate_size(const SampledScene& scene, const BakedSample& sample);

/// Returns the voxels, bytes and seconds of `estimate` times `scale`. The result is for a voxel size at which no piece
/// was baked.
SizeEstimate scaled(const SizeEstimate& estimate, double scale);

/// Returns the nearest of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten.
/// Range   size > 0.
double round_size(double size);

}  // namespace gigabake
