/// The cameras that look for leaks, and what they must see.
#pragma once

#include <vector>

#include "bench/accuracy/leaks/leak_error.h"
#include "bench/accuracy/leaks/leak_eye.h"
#include "bench/accuracy/leaks/leak_scene.h"
#include "kernels/cast/cast.h"
#include "lattice/parameters.h"
#include "viewer/pictures/camera.h"

namespace gigabake::bench {

struct LeakView {
  double elevation_deg = 90;  ///< of the eye above the horizon; 90 looks straight down
  LeakEye eye = LeakEye::anywhere;
  double voxels_per_pixel = 1;  ///< where the scene is nearest to the eye, and a little more behind
  CameraOptions camera;
};

struct LeakViewRange {
  std::vector<double> elevations_deg{90, 60, 35, 20, 10, 5, 2};
  std::vector<double> voxels_per_pixel{1, 1.4, 4, 16, 64, 256, 1024};
  std::vector<double> level_changes{8};  ///< voxels a pixel at the target: a level ends and the next begins there
  int width = 160, height = 120;
};

/// Where cameras stand before a scene.
struct LeakSubject {
  Vector target{};             ///< where they look: on the surface, in its middle
  double width = 0;            ///< of what they look at, at the least where it is seen in full
  std::vector<Vector> points;  ///< of the scene: to every eye one of them is as near as anything
};
LeakSubject subject_of(const LeakScene& scene);

/// Every elevation at every distance, and straight down from a lattice plane too, from which the scene is still this
/// many pixels wide.
inline constexpr double fewest_pixels_wide = 24;
std::vector<LeakView> leak_views(const LeakSubject& subject, const LeakViewRange& range, const BakeParameters& lattice);

/// In closed form, through the middle of each pixel.
AlphaPicture alpha_of_sheets(const LeakScene& scene, const kernels::CastCamera& camera);

}  // namespace gigabake::bench
