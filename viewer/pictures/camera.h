/// Cameras of images.
#pragma once

#include <array>
#include <optional>

#include "core/math/frames.h"
#include "format/scene/paged_scene.h"
#include "kernels/marching/cast_camera.h"

namespace gigabake {

/// The limits of `pixel_error`: sixteen levels finer and coarser than a pixel.
inline constexpr double finest_pixel_error = 0x1p-16, coarsest_pixel_error = 0x1p16;

/// Checks that `pixel_error` is within its limits.
/// Errors  UsageError: pixel_error is outside of [finest_pixel_error, coarsest_pixel_error].
void check_pixel_error(double pixel_error);

/// A clip plane; only the side to which `towards` points is shown.
struct ClipPlane {
  Point<Scene> through_m, towards;  ///< a point of the plane; a vector of any length towards the shown side
  friend bool operator==(const ClipPlane&, const ClipPlane&) = default;
};

/// The part of a scene that is shown, as if the rest did not exist.
struct Clip {
  std::optional<std::array<Point<Scene>, 2>> box_m;  ///< lowest and highest corner
  std::optional<ClipPlane> plane;
  friend bool operator==(const Clip&, const Clip&) = default;
};

struct CameraOptions {
  std::optional<Point<Scene>> eye_m;     ///< default: the nearest eye in the south-east that sees the whole scene
  std::optional<Point<Scene>> target_m;  ///< default: the middle of the occupied space
  std::optional<Point<Scene>> up;        ///< default: z; north if the camera looks straight up or down
  double fovy_deg = 40;
  int width = 1280, height = 720;
  double pixel_error = 1;  ///< max. width of a voxel in pixels; finest_pixel_error to coarsest_pixel_error
  Clip clip;
  bool is_framed = false;  ///< eye_m was computed to show the whole scene; an eye that the user gives is never moved
};

/// Checks the size before memory is allocated for an image.
/// Errors  UsageError: not 1 to 32768 pixels per side, or more than 2^28 pixels.
void check_picture_size(const CameraOptions& options);

/// Returns the camera in lod-0 voxels of the lattice.
/// Cost    Reads no file. Without eye or target, visits the cells or pages that scene.xml lists.
/// Errors  UsageError names the option that is not finite, has no direction or is out of range.
kernels::CastCamera make_camera(const CameraOptions& options, const PagedScene& scene);

/// A range of heights in lod-0 voxels of the lattice.
struct HeightRange {
  double low = 0, high = 1;
};
/// Returns the range of heights of the scene's bounds, or of its cells if the scene has no bounds. Reads no file.
HeightRange occupied_heights(const PagedScene& scene);

}  // namespace gigabake
