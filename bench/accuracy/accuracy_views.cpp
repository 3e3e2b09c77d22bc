#include "bench/accuracy/accuracy_views.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "bench/accuracy/surface_points.h"
#include "core/base/error.h"

namespace gigabake::bench {
namespace {

using Vector = std::array<double, 3>;

constexpr int min_pixels = 8;

Vector along(const Vector& from, const Vector& direction, double distance) {
  return {from[0] + distance * direction[0], from[1] + distance * direction[1], from[2] + distance * direction[2]};
}

struct Direction {
  const char* name;
  double elevation_deg;
};
constexpr Direction directions[] = {{"nadir", 90}, {"oblique", 35}, {"grazing", 10}};

/// Returns half the extent of the box along a direction.
double reach(const TriangleBox& box, const Vector& direction) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) sum += (box.max[a] - box.min[a]) / 2 * std::fabs(direction[a]);
  return sum;
}

Vector middle_of(const TriangleBox& box) {
  return {(box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2, (box.min[2] + box.max[2]) / 2};
}

/// Returns the first intersection of a triangle with the line through `place` along `forward`, or `place` if there is
/// none.
Vector first_surface(const ReferenceCaster& caster, const Vector& place, const Vector& forward) {
  double to_place = 0;
  for (std::size_t a = 0; a < 3; ++a) to_place += (place[a] - middle_of(caster.box())[a]) * forward[a];
  const Vector outside = along(place, forward, -2 * reach(caster.box(), forward) - 1 - to_place);
  const auto hit = caster.first_hit(outside, forward);
  return hit ? along(outside, forward, *hit) : place;
}

int pixels_across(double voxels, double voxels_per_pixel, int maximum) {
  return int(std::clamp(std::ceil(voxels / voxels_per_pixel) + 2, double(min_pixels), double(maximum)));
}

AccuracyView make_view(const ReferenceCaster& caster, const BakeParameters& lattice, const Direction& direction,
                       double voxels_per_pixel, const Vector& place, int width, int height) {
  const TriangleBox& box = caster.box();
  const Vector forward = forward_at(direction.elevation_deg);
  const double level = std::hypot(forward[0], forward[1]);
  const Vector right = level > 0 ? Vector{forward[1] / level, -forward[0] / level, 0} : Vector{1, 0, 0};
  const Vector up =
      level > 0 ? Vector{-forward[2] * forward[0] / level, -forward[2] * forward[1] / level, level} : Vector{0, 1, 0};
  AccuracyView view;
  view.direction = direction.name;
  view.voxels_per_pixel = voxels_per_pixel;
  view.camera.fovy_deg = accuracy_fovy_deg;
  view.camera.width = pixels_across(2 * reach(box, right), voxels_per_pixel, width);
  view.camera.height = pixels_across(2 * reach(box, up), voxels_per_pixel, height);
  const bool holds_all = view.camera.width < width && view.camera.height < height;
  const Vector target = holds_all ? middle_of(box) : first_surface(caster, place, forward);
  double to_target = 0;
  for (std::size_t a = 0; a < 3; ++a) to_target += (target[a] - middle_of(box)[a]) * forward[a];
  const double to_front =
      voxels_per_pixel * view.camera.height / (2 * std::tan(accuracy_fovy_deg * std::numbers::pi / 360));
  const Vector eye = along(target, forward, -(to_front + reach(box, forward) + to_target));
  view.camera.eye_m = to_scene_m(eye, lattice);
  view.camera.target_m = to_scene_m(target, lattice);
  return view;
}

}  // namespace

std::array<double, 3> forward_at(double elevation_deg) {
  constexpr double azimuth = 0.8;
  if (elevation_deg == 90) return {0, 0, -1};
  const double elevation = elevation_deg * std::numbers::pi / 180;
  return {-std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), -std::sin(elevation)};
}

Point<Scene> to_scene_m(const std::array<double, 3>& voxels, const BakeParameters& lattice) {
  std::array<double, 3> m;
  for (std::size_t a = 0; a < 3; ++a) m[a] = lattice.lattice_origin_m[a] + voxels[a] * lattice.voxel_size_m;
  return {m[0], m[1], m[2]};
}

std::string AccuracyView::name() const { return fmt::format("{} {:g}", direction, voxels_per_pixel); }

std::vector<AccuracyView> accuracy_views(const ReferenceCaster& caster, const BakeParameters& lattice,
                                         const std::vector<double>& voxels_per_pixel, int width, int height) {
  std::vector<Vector> places = visible_places(caster.triangles(), std::size(directions) * voxels_per_pixel.size());
  // The first view shows the middle of the scene, if it contains surface, because a user inspects this place first.
  const Vector middle = middle_of(caster.box());
  if (caster.first_hit({middle[0], middle[1], caster.box().max[2] + 1}, {0, 0, -1})) places.front() = middle;
  std::vector<AccuracyView> views;
  for (const Direction& direction : directions)
    for (const double scale : voxels_per_pixel)
      views.push_back(
          make_view(caster, lattice, direction, scale, places[views.size() % places.size()], width, height));
  return views;
}

std::vector<std::array<double, 3>> visible_places(const SourceTriangles& source, std::size_t maximum) {
  constexpr std::uint64_t seed = 20261125;
  // Some points of a masked surface have no alpha, so more points than places are sampled.
  constexpr std::size_t tries = 16;
  const std::vector<Vector> points = surface_points(source, tries * maximum, seed);
  if (points.empty()) throw InputError("the source", "", "has no visible surface; nothing can be compared");
  std::vector<Vector> places;
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
