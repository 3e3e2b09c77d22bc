/// Conversion of stored voxels to the light that rays composite.
#pragma once

#include <array>
#include <cstdint>

#include "format/scene/xml/scene_xml.h"
#include "kernels/light/shade.h"
#include "kernels/marching/scene.h"

namespace gigabake {

/// The property of voxels that an image shows.
enum class Surface : std::uint8_t { colour, normal, coverage, voxel_class };

/// Returns the colour of a class in images: grey of class 0, else one of twelve colours, by class − 1 modulo 12.
std::array<std::uint8_t, 3> class_colour(VoxelClass voxel_class);

/// A converter of stored voxels to the packed voxels that the ray caster composites.
/// The coverage of a voxel along each axis is its directional coverage (`directional_coverage`). Voxels have no
/// coverages at lod 0, with mip filters that store no directions, and in bakes without
/// `directional_coverage`. Their alpha then serves as the coverage along all three axes.
/// The coverage filter of version 1 scenes stored the mean over the axes as alpha. Two of the three axes are parallel
/// to flat ground, so the mean underestimates ground seen from above. Shading computes the coverage of a flat layer
/// from this mean, so that ground does not become transparent.
class Shading {
 public:
  Shading(const kernels::CastLight& light, const SceneHeader& scene, Surface surface = Surface::colour);

  /// Returns the shaded voxel. `normal` is octahedral, and is ignored if the scene has no normals.
  /// `directional_coverage` is null if the level has no directional coverage.
  kernels::PackedVoxel operator()(int lod, const std::uint8_t rgba[4], const std::int8_t* normal,
                                  const std::uint8_t* directional_coverage, VoxelClass voxel_class = no_class) const;

 private:
  Vec3<std::uint8_t> coverage_of(int lod, std::uint8_t alpha, const std::uint8_t* directional_coverage) const;
  Vec3<std::uint8_t> colour_of(const std::uint8_t rgba[4], const std::int8_t* normal, VoxelClass voxel_class) const;

  kernels::CastLight light_;
  kernels::Tables tables_ = kernels::TableStore::host().view();
  Surface surface_;
  bool has_normals_;
  std::array<std::array<std::uint8_t, 256>, kernels::max_cast_lods>
      coverage_;  ///< [lod][alpha]; without `directional_coverage`
};

}  // namespace gigabake
