/// Where a picture is taken from.
#pragma once

#include <array>
#include <optional>

#include "format/scene/paged_scene.h"
#include "kernels/cast/cast.h"
#include "lattice/frames.h"
#include "viewer/stream/page.h"

namespace gigabake {

/// Sixteen levels finer or coarser than a pixel.
inline constexpr double finest_pixel_error = 0x1p-16, coarsest_pixel_error = 0x1p16;

/// Errors  UsageError: not within these two.
void check_pixel_error(double pixel_error);

/// What lies on this side of a plane is shown.
struct ClipPlane {
  Point<Scene> through_m, towards;  ///< a point of it, and which way is shown, of any length
  friend bool operator==(const ClipPlane&, const ClipPlane&) = default;
};

/// What is shown of a scene, as if there were nothing else.
struct Clip {
  std::optional<std::array<Point<Scene>, 2>> box_m;  ///< its lowest and its highest corner
  std::optional<ClipPlane> plane;
  friend bool operator==(const Clip&, const Clip&) = default;
};

struct CameraOptions {
  std::optional<Point<Scene>> eye_m;     ///< default: in the south-east, just far enough to see the whole scene
  std::optional<Point<Scene>> target_m;  ///< default: the middle of what there is
  std::optional<Point<Scene>> up;        ///< default: z; north where the camera looks straight up or down
  double fovy_deg = 40;
  int width = 1280, height = 720;
  double pixel_error = 1;  ///< pixels that a voxel may be wide; finest_pixel_error to coarsest_pixel_error
  Clip clip;
  bool is_framed = false;  ///< eye_m was chosen to show the whole scene; an eye that the user gives is never moved
};

/// Before memory is taken for a picture. Errors  UsageError: not 1 to 32768 pixels a side, or more than 2^28.
void check_picture_size(const CameraOptions& options);

/// Cost    Where eye or target are left open: of a few cells, the first page of nodes of each, one at a time; of more,
///         the root parent's finest level, where there is one; else a look at each cell's window.
/// Errors  UsageError naming the option: not finite, no direction, sizes or angles out of range.
kernels::CastCamera make_camera(const CameraOptions& options, const PagedScene& scene, const PageSource& pages);

/// Between which heights all there is lies, lod-0 voxels of the lattice: to a brick, or to what the root parent tells.
/// Cost    As make_camera() where eye or target are left open.
struct HeightRange {
  double low = 0, high = 1;
};
HeightRange occupied_heights(const PagedScene& scene, const PageSource& pages);

}  // namespace gigabake
