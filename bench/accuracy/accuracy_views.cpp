#include "bench/accuracy/accuracy_views.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "bench/accuracy/surface_points.h"
#include "core/base/error.h"

namespace gigabake::bench {
namespace {

constexpr int min_pixels = 8;

struct Direction {
  const char* name;
  double elevation_deg;
};
constexpr Direction directions[] = {{"nadir", 90}, {"oblique", 35}, {"grazing", 10}};

/// Returns half the extent of the box along a direction.
double reach(const TriangleBox& box, const Vec3d& direction) {
  return dot((box.max - box.min) / 2, {std::fabs(direction[0]), std::fabs(direction[1]), std::fabs(direction[2])});
}

/// Returns the first intersection of a triangle with the line through `place` along `forward`, or `place` if there is
/// none.
Vec3d first_surface(const ReferenceCaster& caster, const Vec3d& place, const Vec3d& forward) {
  const double to_place = dot(place - caster.box().centre(), forward);
  const Vec3d outside = place + forward * (-2 * reach(caster.box(), forward) - 1 - to_place);
  const auto hit = caster.first_hit(outside, forward);
  return hit ? outside + forward * *hit : place;
}

int pixels_across(double voxels, double voxels_per_pixel, int maximum) {
  return int(std::clamp(std::ceil(voxels / voxels_per_pixel) + 2, double(min_pixels), double(maximum)));
}

AccuracyView make_view(const ReferenceCaster& caster, const BakeParameters& lattice, const Direction& direction,
                       double voxels_per_pixel, const Vec3d& place, int width, int height) {
  const TriangleBox& box = caster.box();
  const Vec3d forward = forward_at(direction.elevation_deg);
  const double level = std::hypot(forward[0], forward[1]);
  const Vec3d right = level > 0 ? Vec3d{forward[1] / level, -forward[0] / level, 0} : Vec3d{1, 0, 0};
  const Vec3d up =
      level > 0 ? Vec3d{-forward[2] * forward[0] / level, -forward[2] * forward[1] / level, level} : Vec3d{0, 1, 0};
  AccuracyView view;
  view.direction = direction.name;
  view.voxels_per_pixel = voxels_per_pixel;
  view.camera.fovy_deg = accuracy_fovy_deg;
  view.camera.width = pixels_across(2 * reach(box, right), voxels_per_pixel, width);
  view.camera.height = pixels_across(2 * reach(box, up), voxels_per_pixel, height);
  const bool holds_all = view.camera.width < width && view.camera.height < height;
  const Vec3d target = holds_all ? box.centre() : first_surface(caster, place, forward);
  const double to_target = dot(target - box.centre(), forward);
  const double to_front =
      voxels_per_pixel * view.camera.height / (2 * std::tan(accuracy_fovy_deg * std::numbers::pi / 360));
  const Vec3d eye = target - forward * (to_front + reach(box, forward) + to_target);
  view.camera.eye_m = to_scene_m(eye, lattice);
  view.camera.target_m = to_scene_m(target, lattice);
  return view;
}

}  // namespace

Vec3d forward_at(double elevation_deg) {
  constexpr double azimuth = 0.8;
  if (elevation_deg == 90) return {0, 0, -1};
  const double elevation = elevation_deg * std::numbers::pi / 180;
  return {-std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), -std::sin(elevation)};
}

Point<Scene> to_scene_m(const Vec3d& voxels, const BakeParameters& lattice) {
  const Vec3d m = lattice.lattice_origin_m + voxels * lattice.voxel_size_m;
  return {m[0], m[1], m[2]};
}

std::string AccuracyView::name() const { return fmt::format("{} {:g}", direction, voxels_per_pixel); }

std::vector<AccuracyView> accuracy_views(const ReferenceCaster& caster, const BakeParameters& lattice,
                                         const std::vector<double>& voxels_per_pixel, int width, int height) {
  std::vector<Vec3d> places = visible_places(caster.triangles(), std::size(directions) * voxels_per_pixel.size());
  // The first view shows the middle of the scene, if it contains surface, because a user inspects this place first.
  const Vec3d middle = caster.box().centre();
  if (caster.first_hit({middle[0], middle[1], caster.box().max[2] + 1}, {0, 0, -1})) places.front() = middle;
  std::vector<AccuracyView> views;
  for (const Direction& direction : directions)
    for (const double scale : voxels_per_pixel)
      views.push_back(
          make_view(caster, lattice, direction, scale, places[views.size() % places.size()], width, height));
  return views;
}

std::vector<Vec3d> visible_places(const SourceTriangles& source, std::size_t maximum) {
  constexpr std::uint64_t seed = 20261125;
  // Some points of a masked surface have no alpha, so more points than places are sampled.
  constexpr std::size_t tries = 16;
  const std::vector<Vec3d> points = surface_points(source, tries * maximum, seed);
  if (points.empty()) throw InputError("the source", "", "has no visible surface; nothing can be compared");
  std::vector<Vec3d> places;
  for (std::size_t i = 0; i < std::min(maximum, points.size()); ++i)
    places.push_back(points[i * points.size() / std::min(maximum, points.size())]);
  return places;
}

std::uint64_t compared_pixels(const LinearPicture& reference) {
  std::uint64_t pixels = 0;
  for (std::size_t i = 0; i < reference.pixels(); ++i) pixels += reference.alpha(i) > 0 ? 1 : 0;
  return pixels;
}

void expect_surface(const std::filesystem::path& source, const std::string& view, std::uint64_t pixels) {
  if (pixels >= min_compared_pixels) return;
  throw InputError(source, "",
                   fmt::format("the view \"{}\" shows the surface in {} of its pixels, fewer than {}: too little to "
                               "compare; choose smaller voxels, a larger --size or smaller --scales",
                               view, pixels, min_compared_pixels));
}

kernels::CastCamera reference_camera(const CameraOptions& camera, const BakeParameters& lattice) {
  SceneDescription frame;
  frame.voxel_size_m = lattice.voxel_size_m;
  frame.lattice_origin_m = lattice.lattice_origin_m;
  return make_camera(camera, PagedScene::of_cells({}, std::move(frame)));
}

}  // namespace gigabake::bench
