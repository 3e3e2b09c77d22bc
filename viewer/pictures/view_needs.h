/// What drawing a view takes: what voxels must hold, and how rays paint and are lit.
#pragma once

#include <memory>
#include <optional>

#include "viewer/light/shading.h"
#include "viewer/pictures/view.h"

namespace gigabake {

/// What a view needs of the pools' bricks.
struct Filling {
  Surface surface;
  std::optional<SunDirection> lit_by = {};  ///< voxels are lit as they are put in; else they have their own colours
  bool cells_alone = false;                 ///< a tree to each cell
  friend bool operator==(const Filling&, const Filling&) = default;
};

/// Which part of the light pixels are lit by, once it is known what stands in it; nothing where voxels are lit as if
/// nothing did, or not at all.
std::optional<kernels::CastLightPart> light_part_of(const View& view);

Filling filling_of(const View& view);

/// Modes that show light, as bright as it is.
bool shows_light(ViewMode mode);

kernels::CastPaint paint_of(ViewMode mode);

/// Null: the light itself. heights: of the scene, for ViewMode::height alone.
std::shared_ptr<const kernels::SurfaceShader> shader_of(const View& view, const HeightRange& heights);

bool same_picture(const View& a, const View& b);

/// The polygons of a view as its camera sees them: drawn once for pictures that are the same.
class PolygonPictures {
 public:
  /// Borrowed until the next call. Range  view.polygons.
  kernels::CastPolygons drawn(const View& view, const kernels::CastCamera& camera, const SceneHeader& scene,
                              const kernels::CastHaze& haze, const ThreadPool& policy);

 private:
  View of_;
  PolygonPicture picture_;
};

}  // namespace gigabake
