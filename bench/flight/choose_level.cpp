#include <algorithm>
#include <cmath>

#include "bench/flight/mesh_levels.h"

namespace gigabake::bench {
namespace {

double distance_to(const TriangleBox& box, const Vec3d& p) {
  const auto outside = [&](std::size_t a) { return std::max({box.min[a] - p[a], p[a] - box.max[a], 0.0}); };
  return std::hypot(outside(0), outside(1), outside(2));
}

/// Returns true if no point of the box is in front of the plane through the eye.
bool is_behind(const TriangleBox& box, const kernels::CastCamera& camera) {
  const Vec3d half = (box.max - box.min) / 2, forward = Vec3d::from(camera.forward);
  const double reach = dot(half, {std::fabs(forward[0]), std::fabs(forward[1]), std::fabs(forward[2])});
  return dot(box.centre() - Vec3d::from(camera.eye), forward) + reach <= 0;
}

}  // namespace

double pixel_width(const kernels::CastCamera& camera, double distance) {
  const Vec3d up = Vec3d::from(camera.up);
  return distance * 2 * std::hypot(up[0], up[1], up[2]) / camera.height;
}

std::optional<std::size_t> choose_level(const MeshLevels& mesh, const kernels::CastCamera& camera, double max_pixels) {
  if (is_behind(mesh.box, camera)) return {};
  const double max_error = max_pixels * pixel_width(camera, distance_to(mesh.box, Vec3d::from(camera.eye)));
  std::size_t level = mesh.levels.size() - 1;
  while (level > 0 && mesh.levels[level].error > max_error) --level;
  return level;
}

}  // namespace gigabake::bench
