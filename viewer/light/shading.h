/// Conversion of stored voxels to the light that rays composite.
#pragma once

#include <array>
#include <cstdint>

#include "format/scene/xml/scene_xml.h"
#include "kernels/light/shade.h"
#include "kernels/marching/scene.h"

namespace gigabake {

/// The property of a voxel that is shown.
enum class Surface : std::uint8_t { colour, normal, coverage };

/// Shades voxels. A voxel's coverage along each axis is its facing. A voxel has none at lod 0, with filters without
/// directions, and in bakes without facing. Its alpha is then the coverage along all three axes. The coverage filter of
/// version 1 scenes stored the mean over the axes. Two of the three axes are parallel to flat ground, so the mean
/// underestimates ground seen from above. Shading reverses the mean, so that ground does not become transparent.
class Shading {
 public:
  Shading(const kernels::CastLight& light, const SceneHeader& scene, Surface surface = Surface::colour);

  /// Returns the shaded voxel. normal: octahedral; ignored if the scene has no normals. facing: null if the level has
  /// none.
  kernels::CastVoxel operator()(int lod, const std::uint8_t rgba[4], const std::int8_t* normal,
                                const std::uint8_t* facing) const;

 private:
  kernels::CastLight light_;
  Surface surface_;
  bool has_normals_;
  std::array<std::array<std::uint8_t, 256>, kernels::max_cast_lods> coverage_;  ///< without facing: by lod and alpha
};

}  // namespace gigabake
