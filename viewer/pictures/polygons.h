/// Triangles that stand among the voxels of a picture, hide them and are hidden by them.
///
/// They are drawn first, a ray through the middle of each pixel: the first triangle that it meets ends the voxels' ray,
/// and shows where that leaves light. They lie in the sun and the sky as if nothing stood in it, and cast no shadow.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "format/scene/scene_xml.h"
#include "kernels/cast/cast_camera.h"
#include "kernels/cast/shade.h"
#include "lattice/frames.h"
#include "lattice/thread_pool.h"
#include "viewer/light/sun.h"

namespace gigabake {

struct PolygonMesh {
  std::vector<std::array<Point<Scene>, 3>> triangles;  ///< seen from both sides; those that are not finite, from none
  /// Linear RGBA, premultiplied, where a triangle's second and third corner weigh so much. Below half of alpha nothing
  /// is there, else all is. Called by several threads.
  std::function<std::array<float, 4>(std::size_t triangle, float second, float third)> colour;
};

/// What a camera sees of them: CastPolygons, of its picture's pixels.
struct PolygonPicture {
  std::vector<float> distance, rgba;
  kernels::CastPolygons view() const { return {distance.data(), rgba.data()}; }
};

/// haze: that lies before them.
PolygonPicture draw_polygons(const PolygonMesh& mesh, const SceneHeader& scene, const kernels::CastCamera& camera,
                             const kernels::CastLight& light, const kernels::CastHaze& haze, const ThreadPool& policy);

}  // namespace gigabake
