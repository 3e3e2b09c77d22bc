/// Estimate of a bake at one voxel size from sample pieces of the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace gigabake {

/// Result of baking one column of one tile in isolation.
struct BakedPiece {
  std::uint32_t tile = 0;
  double crossings = 0;  ///< estimated projected lod-0 voxels of its surface (ColumnExtent::crossings)
  std::uint64_t voxels_lod0 = 0, voxels = 0;  ///< voxels: of all levels
  std::uint64_t level_bytes = 0, shard_bytes = 0;
  std::uint32_t cells = 0;
  double read_s = 0, kernel_s = 0, write_s = 0;
};

/// Measurements of the sample pieces at one voxel size.
struct BakedSample {
  std::vector<BakedPiece> pieces;  ///< drawn without replacement, with probabilities proportional to crossings
  double wall_s = 0;               ///< stages overlap, as in a bake
};

/// The scene that the pieces were drawn from, in voxels of the same size.
struct SampledScene {
  double crossings = 0;
  std::vector<std::uint64_t> tile_triangles;  ///< by tile
  std::uint64_t cells = 0;
  int ranks = 1;  ///< number of ranks, each as fast as the one that baked the pieces
};

struct SizeEstimate {
  std::uint64_t voxels_lod0 = 0, voxels = 0, bytes = 0;
  std::optional<double> bake_s;  ///< without the scan; none if no piece was baked
  double voxels_error = 0;       ///< relative standard error of the voxels
  double share = 0;              ///< fraction of the surface that was baked
};

/// Estimates a bake. Without pieces: as many voxels as the surface's projected voxels, at three bytes each.
/// Exact   If all pieces were baked, the sums of the pieces. Otherwise the rest is estimated by the mean of the pieces'
///         voxels per projected voxel (Hansen and Hurwitz 1943). Overlapping tiles are counted separately.
SizeEstimate estimate_size(const SampledScene& scene, const BakedSample& sample);

/// Returns the estimate of another voxel size multiplied by `scale`, for a size at which no piece was baked.
SizeEstimate scaled(const SizeEstimate& estimate, double scale);

/// Returns the nearest of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten.
/// Range   size > 0.
double round_size(double size);

}  // namespace gigabake
