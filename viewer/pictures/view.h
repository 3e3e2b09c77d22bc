/// What is to be seen of a scene: from where, which property of it, and in which light.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "kernels/cast/shader.h"
#include "lattice/rules.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/camera.h"
#include "viewer/pictures/picture.h"
#include "viewer/pictures/polygons.h"

namespace gigabake {

enum class ViewMode : std::uint8_t {
  lit,       ///< sun, sky and air
  albedo,    ///< the surface's own colour
  normal,    ///< x, y, z from -1 to 1 as red, green, blue
  coverage,  ///< black to white
  lod,       ///< one colour a level
  cell,      ///< one colour a cell
  requests,  ///< red where something finer was asked for, green elsewhere
  sun,       ///< what the sun alone lights, with shadows
  sky,       ///< what the sky alone lights, as much of it as is seen
  shadow,    ///< how much of the sun is seen: white all of it
  height,    ///< by height above the scene's lowest voxel
  slope,     ///< by how steep the surface is
};

/// Whether surfaces stand in each other's light, in ViewMode::lit.
enum class Shadows : std::uint8_t { off, on };

template <>
constexpr auto names_of<Shadows>() {
  return std::to_array<std::string_view>({"off", "on"});
}

template <>
constexpr auto names_of<ViewMode>() {
  return std::to_array<std::string_view>(
      {"lit", "albedo", "normal", "coverage", "lod", "cell", "requests", "sun", "sky", "shadow", "height", "slope"});
}

/// Whether what lies between two levels is filtered from both.
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
  /// In ViewMode::lit, instead of its light (kernels/cast/shader.h); null: none.
  std::shared_ptr<const kernels::SurfaceShader> shader = {};
  std::shared_ptr<const PolygonMesh> polygons = {};  ///< that stand among the voxels; null: none
};

}  // namespace gigabake
