#include "bench/accuracy/leaks/leak_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/accuracy/accuracy_views.h"

namespace gigabake::bench {
namespace {

/// Returns the maximum distance by which the scene is nearer than its target to an eye that looks along `forward`.
double reach_towards_eye(const LeakSubject& subject, const Vec3d& forward) {
  double reach = 0;
  for (const Vec3d& p : subject.points) reach = std::max(reach, dot(subject.target - p, forward));
  return reach;
}

/// The spacing, in voxels, of lattice planes that are also lattice planes of the six next coarser levels.
constexpr double lattice_plane = 64;

LeakView make_view(const LeakSubject& subject, double elevation_deg, LeakEye kind, double voxels_per_pixel,
                   const LeakViewRange& range, const BakeParameters& lattice) {
  LeakView view{elevation_deg, kind, voxels_per_pixel, {}};
  view.camera.fovy_deg = accuracy_fovy_deg;
  view.camera.width = range.width;
  view.camera.height = range.height;
  const Vec3d forward = forward_at(elevation_deg);
  double distance = voxels_per_pixel * range.height / (2 * std::tan(accuracy_fovy_deg * std::numbers::pi / 360));
  if (kind != LeakEye::at_level_change) distance += reach_towards_eye(subject, forward);
  Vec3d eye = subject.target - forward * distance;
  if (kind == LeakEye::on_lattice) eye[2] = lattice_plane * std::ceil(eye[2] / lattice_plane);
  view.camera.eye_m = to_scene_m(eye, lattice);
  view.camera.target_m = to_scene_m(subject.target, lattice);
  return view;
}

}  // namespace

LeakSubject subject_of(const LeakScene& scene) {
  LeakSubject subject{scene.target, scene.width, {}};
  for (const sample::GlbMesh& mesh : scene.model.meshes)
    for (std::size_t v = 0; v < mesh.position.size(); v += 3)
      subject.points.push_back({mesh.position[v], -double(mesh.position[v + 2]), mesh.position[v + 1]});
  return subject;
}

std::vector<LeakView> leak_views(const LeakSubject& subject, const LeakViewRange& range,
                                 const BakeParameters& lattice) {
  std::vector<LeakView> views;
  const auto add = [&](double elevation_deg, LeakEye kind, const std::vector<double>& scales) {
    for (const double voxels_per_pixel : scales)
      if (subject.width >= min_pixels_wide * voxels_per_pixel)
        views.push_back(make_view(subject, elevation_deg, kind, voxels_per_pixel, range, lattice));
  };
  for (const double elevation_deg : range.elevations_deg) {
    add(elevation_deg, LeakEye::anywhere, range.voxels_per_pixel);
    if (elevation_deg == 90) add(elevation_deg, LeakEye::on_lattice, range.voxels_per_pixel);
    add(elevation_deg, LeakEye::at_level_change, range.level_changes);
  }
  return views;
}

AlphaPicture alpha_of_sheets(const LeakScene& scene, const kernels::CastCamera& camera) {
  AlphaPicture picture{camera.width, camera.height, {}};
  const kernels::CastScene nowhere;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const kernels::CastLine line = kernels::line_of_sight(nowhere, camera, x, y);
      picture.alpha.push_back(
          alpha_through(scene.sheets, scene.sheet_alpha, Vec3d::from(line.origin), Vec3d::from(line.direction)));
    }
  return picture;
}

}  // namespace gigabake::bench
