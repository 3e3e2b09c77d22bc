/// Conversion of stored voxels to the light that rays composite: its parameters for a scene.
#pragma once

#include <array>
#include <cstdint>

#include "format/scene/xml/scene_xml.h"
#include "kernels/light/stored_voxel.h"
#include "kernels/marching/scene.h"

namespace gigabake {

/// The property of voxels that an image shows.
using Surface = kernels::ShownProperty;

/// Returns the colour of a class in images: grey of class 0, else one of twelve colours, by class − 1 modulo 12.
std::array<std::uint8_t, 3> class_colour(VoxelClass voxel_class);

/// Parameters of the conversion of stored voxels to the packed voxels that the ray caster composites.
/// The coverage of a voxel along each axis is its directional coverage (`directional_coverage`). Voxels have no
/// coverages at lod 0, with mip filters that store no directions, and in bakes without
/// `directional_coverage`. Their alpha then serves as the coverage along all three axes.
/// The coverage filter of version 1 scenes stored the mean over the axes as alpha. Two of the three axes are parallel
/// to flat ground, so the mean underestimates ground seen from above. Shading computes the coverage of a flat layer
/// from this mean, so that ground does not become transparent.
class Shading {
 public:
  Shading(const kernels::CastLight& light, const SceneHeader& scene, Surface surface = Surface::colour);
  Shading(const Shading&) = delete;
  Shading& operator=(const Shading&) = delete;

  /// Returns the parameters. They refer to tables of this object and of TableStore::host().
  const kernels::StoredVoxelShading& parameters() const { return parameters_; }

 private:
  std::array<std::array<std::uint8_t, 256>, kernels::max_cast_lods>
      coverage_;  ///< [lod][alpha]; without `directional_coverage`
  kernels::StoredVoxelShading parameters_;
};

}  // namespace gigabake
