/// How stored voxels become light.
#pragma once

#include <array>
#include <cstdint>

#include "format/scene/scene_xml.h"
#include "kernels/cast/scene.h"
#include "kernels/cast/shade.h"

namespace gigabake {

/// What of a voxel is shown.
enum class Surface : std::uint8_t { colour, normal, coverage };

/// A voxel's coverage along each axis is its facing; where it has none, at lod 0, with filters without directions and
/// in bakes that declined it, it is its alpha along all three. The coverage filter of scenes of version 1 stored the
/// mean of the three: ground is seen face on, but two of the three look along it. There that share is put back, so that
/// ground does not grow transparent.
class Shading {
 public:
  Shading(const kernels::CastLight& light, const SceneHeader& scene, Surface surface = Surface::colour);

  /// normal: octahedral; not read where the scene has none. facing: null where the level has none.
  kernels::CastVoxel operator()(int lod, const std::uint8_t rgba[4], const std::int8_t* normal,
                                const std::uint8_t* facing) const;

 private:
  kernels::CastLight light_;
  Surface surface_;
  bool has_normals_;
  std::array<std::array<std::uint8_t, 256>, kernels::max_cast_lods> coverage_;  ///< without facing: by lod and alpha
};

}  // namespace gigabake
