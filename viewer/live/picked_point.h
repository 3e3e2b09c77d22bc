/// The scene point that a pixel of an image shows.
#pragma once

#include <optional>
#include <string>

#include "core/math/frames.h"
#include "core/math/vec3.h"
#include "kernels/marching/cast_camera.h"
#include "viewer/pictures/picture.h"

namespace gigabake {

/// The rays of an image, and their transformation to scene coordinates.
struct PictureRays {
  kernels::CastCamera camera;  ///< in lod-0 voxels; width and height are the image's size
  Vec3d lattice_origin_m{};
  double voxel_size_m = 1;
  std::optional<Geodetic> origin;  ///< set if the scene has an origin on the earth
};

struct PickedPoint {
  Point<Scene> at_m;
  double distance_m = 0;          ///< from the eye to the point
  std::optional<Geodetic> place;  ///< set if the scene has an origin on the earth
};

/// Returns the scene point that the image shows at (right, down); nullopt if the pixel shows no surface or is not
/// rendered yet. `right` and `down` are fractions of the image's width and height, 0 to 1 from the upper left corner.
/// `rays` are the rays of `picture`.
/// Exact   The point is as exact as the image's depth, the distance at which half of the pixel's light is absorbed.
std::optional<PickedPoint> picked_point(const Picture& picture, const PictureRays& rays, double right, double down);

/// Returns a text such as "lat 48.1234567° lon 11.1234567° 520.25 m, 83.10 m away". If the scene has no origin on the
/// earth, the coordinates are scene metres.
std::string place_text(const PickedPoint& point);
/// Returns a text such as "12.34 m: 10.00 m horizontal, 7.23 m vertical".
std::string distance_text(const PickedPoint& from, const PickedPoint& to);

}  // namespace gigabake
