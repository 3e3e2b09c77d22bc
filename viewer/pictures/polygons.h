/// Triangles among the voxels of an image; triangles and voxels occlude each other.
///
/// Triangles are rendered first, with a ray through the middle of each pixel. The first triangle hit ends the voxels'
/// ray and is shown through the remaining transmittance. Triangles are lit by sun and sky without shadows, and cast no
/// shadows.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/math/frames.h"
#include "format/scene/xml/scene_xml.h"
#include "kernels/light/lighting.h"
#include "kernels/marching/cast_camera.h"
#include "viewer/light/sun.h"

namespace gigabake {

struct PolygonMesh {
  std::vector<std::array<Point<Scene>, 3>> triangles;  ///< two-sided; triangles that are not finite are ignored
  /// Returns linear RGBA, premultiplied, at the given weights of a triangle's second and third corner. A point of alpha
  /// below 0.5 is a hole, any other is opaque. Called by several threads.
  std::function<std::array<float, 4>(std::size_t triangle, float second, float third)> colour;
};

/// The triangles seen by a camera: CastPolygons, per pixel of its image.
struct PolygonPicture {
  std::vector<float> distance, rgba;
  kernels::CastPolygons view() const { return {distance.data(), rgba.data()}; }
};

/// Renders the triangles. haze: between the eye and the triangles.
PolygonPicture draw_polygons(const PolygonMesh& mesh, const SceneHeader& scene, const kernels::CastCamera& camera,
                             const kernels::CastLight& light, const kernels::CastHaze& haze, const ThreadPool& policy);

}  // namespace gigabake
