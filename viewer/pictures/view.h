/// Description of an image: camera, displayed property and light.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "core/base/rules.h"
#include "kernels/light/shader.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/camera.h"
#include "viewer/pictures/picture.h"
#include "viewer/pictures/polygons.h"

namespace gigabake {

enum class ViewMode : std::uint8_t {
  lit,          ///< sun, sky and air
  albedo,       ///< the surface's own colour
  normal,       ///< x, y, z from -1 to 1 as red, green, blue
  coverage,     ///< coverage of voxels, from black to white
  lod,          ///< one colour per level
  cell,         ///< one colour per cell
  requests,     ///< red where finer data was requested, green elsewhere
  sun,          ///< direct sunlight only, with shadows
  sky,          ///< skylight only, occluded by surfaces
  shadow,       ///< visible fraction of the sun; white: the whole sun is visible
  height,       ///< colours by height above the scene's lowest voxel
  slope,        ///< colours by the steepness of the surface
  voxel_class,  ///< one colour per class
};

/// Shadows cast by surfaces in ViewMode::lit.
enum class Shadows : std::uint8_t { off, on };

template <>
constexpr auto names_of<Shadows>() {
  return std::to_array<std::string_view>({"off", "on"});
}

template <>
constexpr auto names_of<ViewMode>() {
  return std::to_array<std::string_view>({"lit", "albedo", "normal", "coverage", "lod", "cell", "requests", "sun",
                                          "sky", "shadow", "height", "slope", "class"});
}

/// Blending of the two adjacent levels (kernels/marching/level_blend.h).
enum class LevelBlend : std::uint8_t { off, on };

template <>
constexpr auto names_of<LevelBlend>() {
  return std::to_array<std::string_view>({"off", "on"});
}

struct View {
  CameraOptions camera;
  ViewMode mode = ViewMode::lit;
  Background background;
  PictureLight light = PictureLight::srgb;
  SunDirection sun = {};
  Shadows shadows = Shadows::off;
  LevelBlend level_blend = LevelBlend::off;
  /// The shader that replaces the light of ViewMode::lit (kernels/light/shader.h); null: no replacement.
  std::shared_ptr<const kernels::SurfaceShader> shader = {};
  std::shared_ptr<const PolygonMesh> polygons = {};  ///< triangles among the voxels; null: none
};

}  // namespace gigabake
