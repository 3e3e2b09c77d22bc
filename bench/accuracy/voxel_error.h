/// How far the voxels of a bake are from the source's triangles: which are missing, which are too many, and how far off
/// colour, alpha and normal are.
///
/// Neither snap nor bins, weights or pyramids of the kernels are in it: triangles are as the source places them, texels
/// the finest, and voxels come from the shards.
#pragma once

#include <cstdint>
#include <filesystem>

#include "bench/accuracy/reference_caster.h"

namespace gigabake::bench {

/// What is looked at: spread evenly, at random within each share of the surface and of the voxels.
struct VoxelErrorSample {
  std::uint64_t points = 200000;  ///< of the surface, at most
  std::uint64_t voxels = 50000;   ///< at most
  int texels = 64;                ///< points in each voxel, at which the source's colour is taken
  std::uint64_t seed = 1;
};

/// Of lod 0; lengths in its voxels.
struct VoxelError {
  std::uint64_t points = 0, voxels = 0;  ///< that were looked at; of the points those that the alpha test leaves
  /// Shares of the surface with no voxel nearer than 1/256 (a snapped vertex moves by up to 1/512), ½ and 1.
  double missed = 0, missed_by_half = 0, missed_by_one = 0;
  /// Shares of voxels without a triangle nearer to their cube than 1/256, and with none nearer to their centre than
  /// ½ + 1/256 and √3/2 + 1/256; and the farthest, 64 at most.
  double extra = 0, beyond_half = 0, beyond_whole = 0, farthest = 0;
  double normal_deg = 0, normal_99_deg = 0;  ///< to the nearest triangle's outside: mean, and 99 % are below; or 0
  std::uint64_t coloured = 0;  ///< voxels with at least 10⁻⁴ voxel² of surface, whose alpha was compared
  double texels = 0;  ///< along the edge of such a voxel: the root of those in a voxel²; in the mean over them
  double alpha_bias = 0, rms_alpha = 0;
  double rms_colour = 0, delta_e = 0;  ///< linear RGB, straight; CIE76: where both alphas are at least a tenth
};

/// scene: a bake of the caster's source. coarser: its voxels are so many times those of the caster's lattice, which has
/// the same origin.
/// Exact   The same for any number of threads, on one machine.
/// Errors  InputError: a shard that cannot be read.
VoxelError voxel_error(const ReferenceCaster& caster, const std::filesystem::path& scene, int coarser,
                       const VoxelErrorSample& sample, int threads);

}  // namespace gigabake::bench
