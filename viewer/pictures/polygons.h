/// Triangles among the voxels of an image; triangles and voxels occlude each other.
///
/// Triangles are rendered first, with a ray through the middle of each pixel. The ray through the voxels ends at the
/// nearest triangle, which is composited with the remaining transmittance. Triangles are lit by sun and sky without
/// shadows, and cast no shadows.
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
  /// Returns the linear, premultiplied RGBA of a point. `second` and `third` are the barycentric weights of the
  /// triangle's second and third corner. A point of alpha below 0.5 is a hole, any other point is opaque. Several
  /// threads call this function concurrently.
  std::function<std::array<float, 4>(std::size_t triangle, float second, float third)> colour;
};

/// The rendered triangles: the arrays of kernels::CastPolygons, with one entry per pixel of the image.
struct PolygonPicture {
  std::vector<float> distance, rgba;
  kernels::CastPolygons view() const { return {distance.data(), rgba.data()}; }
};

/// Renders the triangles. `haze` is the haze between the eye and the triangles.
PolygonPicture draw_polygons(const PolygonMesh& mesh, const SceneHeader& scene, const kernels::CastCamera& camera,
                             const kernels::CastLight& light, const kernels::CastHaze& haze, const ThreadPool& policy);

}  // namespace gigabake
