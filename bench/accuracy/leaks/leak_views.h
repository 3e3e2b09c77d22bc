/// The cameras of the leak tests, and the alpha that they must show.
#pragma once

#include <vector>

#include "bench/accuracy/leaks/leak_error.h"
#include "bench/accuracy/leaks/leak_eye.h"
#include "bench/accuracy/leaks/leak_scene.h"
#include "core/octree/parameters.h"
#include "kernels/marching/cast.h"
#include "viewer/pictures/camera.h"

namespace gigabake::bench {

struct LeakView {
  double elevation_deg = 90;  ///< of the eye above the horizon; 90: looks straight down
  LeakEye eye = LeakEye::anywhere;
  double voxels_per_pixel = 1;  ///< where the scene is nearest to the eye; a little more behind
  CameraOptions camera;
};

struct LeakViewRange {
  std::vector<double> elevations_deg{90, 60, 35, 20, 10, 5, 2};
  std::vector<double> voxels_per_pixel{0.25, 1, 1.4, 4, 16, 64, 256, 1024};
  std::vector<double> level_changes{8};  ///< voxels per pixel at the target, where the level changes
  int width = 160, height = 120;
};

/// The part of a scene that cameras show.
struct LeakSubject {
  Vec3d target{};             ///< point at which cameras look: in the middle of the surface
  double width = 0;           ///< minimum width of the subject in views that show the whole subject
  std::vector<Vec3d> points;  ///< points of the scene, including the nearest point for every eye
};
LeakSubject subject_of(const LeakScene& scene);

/// The minimum width of the scene in a view, in pixels.
inline constexpr double min_pixels_wide = 24;
/// Returns a view from each elevation at each distance, and the vertical view also from a lattice plane. Omits views in
/// which the scene is less than min_pixels_wide wide.
std::vector<LeakView> leak_views(const LeakSubject& subject, const LeakViewRange& range, const BakeParameters& lattice);

/// Returns the exact alpha along the ray through each pixel's centre.
AlphaPicture alpha_of_sheets(const LeakScene& scene, const kernels::CastCamera& camera);

}  // namespace gigabake::bench
