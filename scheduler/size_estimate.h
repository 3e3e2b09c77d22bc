/// What a bake of some voxel size will come to, from pieces of the scene that were baked.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace gigabake {

/// One column of one tile, baked without the others.
struct BakedPiece {
  std::uint32_t tile = 0;
  double crossings = 0;  ///< lod-0 voxels that its surface was thought to cross (ColumnExtent::crossings)
  std::uint64_t voxels_lod0 = 0, voxels = 0;  ///< voxels: of all levels
  std::uint64_t level_bytes = 0, shard_bytes = 0;
  std::uint32_t cells = 0;
  double read_s = 0, kernel_s = 0, write_s = 0;
};

/// All that was baked of one voxel size.
struct BakedSample {
  std::vector<BakedPiece> pieces;  ///< drawn without return, each with a chance in proportion to its crossings
  double wall_s = 0;               ///< stages overlap, as in a bake
};

/// The scene of which these are pieces, in voxels of the same size.
struct SampledScene {
  double crossings = 0;
  std::vector<std::uint64_t> tile_triangles;  ///< by tile
  std::uint64_t cells = 0;
  int ranks = 1;  ///< that share the work as the one did that baked the pieces
};

struct SizeEstimate {
  std::uint64_t voxels_lod0 = 0, voxels = 0, bytes = 0;
  std::optional<double> bake_s;  ///< without the survey; none where nothing was baked
  double voxels_error = 0;       ///< standard error of the voxels, as a share of them
  double share = 0;              ///< of the surface that was baked
};

/// Without pieces: as many voxels as the surface crosses, at three bytes each.
/// Exact   All pieces baked: their sums. Otherwise what was not baked has, to each crossing, the mean of the pieces'
///         voxels to a crossing (Hansen and Hurwitz 1943). Tiles that lie over each other are counted one by one.
SizeEstimate estimate_size(const SampledScene& scene, const BakedSample& sample);

/// A sample of another voxel size, where nothing could be baked at this one: `scale` times as large.
SizeEstimate scaled(const SizeEstimate& estimate, double scale);

/// The nearest of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten. Range  size > 0.
double round_size(double size);

}  // namespace gigabake
