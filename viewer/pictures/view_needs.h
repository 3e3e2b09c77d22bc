/// Requirements of a view: the contents of voxels, debug colours and lighting.
#pragma once

#include <memory>
#include <optional>

#include "viewer/light/shading.h"
#include "viewer/pictures/view.h"

namespace gigabake {

/// The contents that a view requires in the bricks of the pools.
struct Filling {
  Surface surface;
  std::optional<SunDirection> lit_by = {};  ///< light applied to voxels at upload; nullopt: voxels stay unlit
  bool cells_alone = false;                 ///< one tree per cell
  friend bool operator==(const Filling&, const Filling&) = default;
};

/// Returns the part of the light that is applied per pixel after casting. Returns nullopt if voxels are lit at upload
/// without shadows, or not lit at all.
std::optional<kernels::CastLightPart> light_part_of(const View& view);

Filling filling_of(const View& view);

/// Returns true if the mode shows the intensity of light.
bool shows_light(ViewMode mode);

kernels::DebugColor debug_color_of(ViewMode mode);

/// Returns the view's shader; null: kernels::LitShader. `heights` is the scene's range of heights, used only by
/// ViewMode::height.
std::shared_ptr<const kernels::SurfaceShader> shader_of(const View& view, const HeightRange& heights);

bool same_picture(const View& a, const View& b);

/// A cache of one view's rendered polygons, reused while the view stays the same.
class PolygonPictures {
 public:
  /// Returns the polygons of the view. The pointers are valid until the next call.
  /// Range   view.polygons is not null.
  kernels::CastPolygons drawn(const View& view, const kernels::CastCamera& camera, const SceneHeader& scene,
                              const kernels::CastHaze& haze, const ThreadPool& policy);

 private:
  View of_;
  PolygonPicture picture_;
};

}  // namespace gigabake
