/// How stored voxels become light.
#pragma once

#include <array>
#include <cstdint>

#include "format/scene_xml.h"
#include "kernels/cast_scene.h"
#include "kernels/cast_shade.h"

namespace gigabake {

/// What of a voxel is shown.
enum class Surface : std::uint8_t { colour, normal, coverage };

/// The coverage filter stores the mean of what three views along the axes see. Ground is seen face on, but two of the
/// three look along it: where a flat opaque layer has coverage 1 on lod 0 it has 0.67 on lod 1, 0.52 on lod 2, and so
/// on. That share is put back, so that ground does not grow transparent with distance; what was translucent on lod 0
/// stays as it was.
class Shading {
 public:
  Shading(const kernels::CastLight& light, const SceneDescription& scene, Surface surface = Surface::colour);

  /// normal: octahedral; not read where the scene has none.
  kernels::CastVoxel operator()(int lod, const std::uint8_t rgba[4], const std::int8_t* normal) const;

 private:
  kernels::CastLight light_;
  Surface surface_;
  bool has_normals_;
  std::array<std::array<std::uint16_t, 256>, kernels::max_cast_lods> extinction_;  ///< by lod and coverage
};

}  // namespace gigabake
