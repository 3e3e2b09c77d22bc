#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "bench/accuracy/accuracy_views.h"
#include "bench/hard/surfaces/baked_surface.h"
#include "bench/hard/surfaces/surface_bounds.h"

namespace gigabake::bench {
namespace {

/// Pixels around the scene, which also hold what an image shows beyond the true silhouettes.
constexpr int margin = 8;
/// Lines per voxel of the reference: several lines hit each object of 0.1 voxel.
constexpr double lines_per_voxel = 64;

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  double size() const { return high - low; }
};

Extent extent_along(const std::vector<ConvexBody>& bodies, const Vec3d& direction) {
  Extent extent;
  for (const ConvexBody& body : bodies)
    for (const Vec3d& corner : body.corners) {
      const double at = dot(corner, direction);
      extent = {std::min(extent.low, at), std::max(extent.high, at)};
    }
  return extent;
}

/// Returns a camera that shows the whole scene. A pixel is `voxels_per_pixel` wide where the scene is nearest.
CameraOptions whole_view(const std::vector<ConvexBody>& bodies, double elevation_deg, double voxels_per_pixel) {
  const Vec3d from = forward_at(elevation_deg) * -1.0;
  const Pinhole axes(narrow_camera({0, 0, 0}, from, voxels_per_pixel, 1, 1));
  const Extent right = extent_along(bodies, axes.right()), up = extent_along(bodies, axes.up()),
               depth = extent_along(bodies, axes.forward());
  const auto pixels = [&](const Extent& e) { return int(std::ceil(e.size() / voxels_per_pixel)) + 2 * margin; };
  const Vec3d nearest =
      axes.right() * ((right.low + right.high) / 2) + axes.up() * ((up.low + up.high) / 2) + axes.forward() * depth.low;
  return narrow_camera(nearest, from, voxels_per_pixel, pixels(right), pixels(up));
}

double covered_pixels(const Picture& picture) {
  double sum = 0;
  for (std::size_t i = 3; i < picture.linear.size(); i += 4) sum += double(picture.linear[i]);
  return sum;
}

}  // namespace

HardResult measure_area(const SurfaceScene& scene, const HardRange& goal, BakedSurface& baked) {
  HardResult result;
  for (const double voxels_per_pixel : {1., 4., 16.}) {
    double worst = 1;
    for (const double elevation_deg : {90., 35., 10.}) {
      const CameraOptions camera = whole_view(scene.bodies, elevation_deg, voxels_per_pixel);
      const double reference = silhouette_area(scene.bodies, Pinhole(camera), lines_per_voxel * voxels_per_pixel);
      const double ratio = covered_pixels(baked.image(camera, ViewMode::albedo)) / reference;
      if (std::fabs(std::log(ratio)) >= std::fabs(std::log(worst))) worst = ratio;
    }
    result.figures.push_back(bounded(scene.name, fmt::format("area at {:g}", voxels_per_pixel), "", worst, goal));
  }
  return result;
}

}  // namespace gigabake::bench
