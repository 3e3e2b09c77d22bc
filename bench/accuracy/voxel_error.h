/// The errors of baked voxels relative to the source's triangles: missing voxels, extra voxels, and errors of colour,
/// alpha and normal.
///
/// The reference uses no vertex snapping, bins, weights or texture pyramids of the kernels. Triangles lie exactly where
/// the source places them, and texels are taken from the finest level. Voxels are read from the shards.
#pragma once

#include <cstdint>
#include <filesystem>

#include "bench/accuracy/reference_caster.h"

namespace gigabake::bench {

/// The numbers of samples. The samples are stratified: one sample lies at random in each of equal parts of the surface
/// and of the voxels.
struct VoxelErrorSample {
  std::uint64_t points = 200000;  ///< max points of the surface
  std::uint64_t voxels = 50000;   ///< max
  int texels = 64;                ///< points in each voxel at which the source's colour is sampled
  std::uint64_t seed = 1;
};

/// The errors of lod-0 voxels; lengths are in lod-0 voxels.
struct VoxelError {
  std::uint64_t points = 0, voxels = 0;  ///< numbers of samples, without points that the alpha test rejects
  /// Fractions of the surface without a voxel within a distance of 1/256, ½ and 1. A snapped vertex moves by up to
  /// 1/512.
  double missed = 0, missed_by_half = 0, missed_by_one = 0;
  /// `extra` is the fraction of voxels without a triangle within 1/256 of their cube. `beyond_half` and `beyond_whole`
  /// are the fractions of voxels without a triangle within ½ + 1/256 and √3/2 + 1/256 of their centre. `max_distance`
  /// is the max distance from a centre to the nearest triangle, at most 64.
  double extra = 0, beyond_half = 0, beyond_whole = 0, max_distance = 0;
  /// The angle to the normal of the nearest triangle: mean and 99th percentile. Both are 0 if the scene has no normals.
  double normal_deg = 0, normal_99_deg = 0;
  std::uint64_t coloured = 0;  ///< voxels with at least 10⁻⁴ voxel² of surface; their alpha was compared
  double texels = 0;           ///< mean over these voxels: texels along a voxel's edge (root of texels per voxel²)
  double alpha_bias = 0, rms_alpha = 0;
  double rms_colour = 0, delta_e = 0;  ///< straight linear RGB; CIE76; where both alphas are at least 0.1
};

/// Measures the voxels of a scene that was baked from the caster's source.
///
/// `coarser` is the edge of the scene's voxels divided by the edge of the caster's voxels. Both lattices have the same
/// origin.
/// Exact   Independent of the number of threads, on one machine.
/// Errors  InputError: a shard cannot be read.
VoxelError voxel_error(const ReferenceCaster& caster, const std::filesystem::path& scene, int coarser,
                       const VoxelErrorSample& sample, int threads);

}  // namespace gigabake::bench
