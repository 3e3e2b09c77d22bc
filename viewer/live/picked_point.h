/// The place that a pixel of a picture shows.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "kernels/cast/cast_camera.h"
#include "lattice/frames.h"
#include "viewer/pictures/picture.h"

namespace gigabake {

/// How the rays of a picture lie in a scene.
struct PictureRays {
  kernels::CastCamera camera;  ///< voxels; its width and height are the picture's
  std::array<double, 3> lattice_origin_m{};
  double voxel_size_m = 1;
  std::optional<Geodetic> origin;  ///< of a scene on the earth
};

struct PickedPoint {
  Point<Scene> at_m;
  double distance_m = 0;          ///< from the eye
  std::optional<Geodetic> place;  ///< of a scene on the earth
};

/// right, down: 0 to 1, from the picture's upper left corner. rays: those that the picture was drawn with. Nothing
/// where the pixel shows no surface, or is not drawn yet. Exact   As far as the picture's distance is: where half of
/// the pixel's light was gone.
std::optional<PickedPoint> picked_point(const Picture& picture, const PictureRays& rays, double right, double down);

/// "48.1234567° 11.1234567° 520.25 m, 83.10 m away"; in scene metres where the scene has no place on the earth.
std::string place_text(const PickedPoint& point);
/// "12.34 m: 10.00 m across, 7.23 m up"
std::string distance_text(const PickedPoint& from, const PickedPoint& to);

}  // namespace gigabake
