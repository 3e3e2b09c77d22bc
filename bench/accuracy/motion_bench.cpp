#include "bench/accuracy/motion_bench.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

#include "bench/accuracy/accuracy_scene.h"
#include "bench/accuracy/flip.h"
#include "core/base/error.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/image_files.h"

namespace gigabake::bench {
namespace {

constexpr int pairs_of_path = 6;
constexpr double fovy_deg = 40;

struct MotionPair {
  std::string path;
  double at;
  CameraOptions cameras[2];
};

/// Returns twice the tangent of half the field of view, divided by the height: the width of a pixel at distance 1.
double pixel_angle(double fovy, int height) { return 2 * std::tan(fovy * std::numbers::pi / 360) / height; }

CameraOptions camera_at(const Vec3d& eye, const Vec3d& forward, double fovy, const AccuracyBenchRequest& request) {
  CameraOptions camera;
  camera.eye_m = to_scene_m(eye, request.scene.parameters);
  camera.target_m = to_scene_m(eye + forward * 1000, request.scene.parameters);
  camera.fovy_deg = fovy;
  camera.width = request.width;
  camera.height = request.height;
  return camera;
}

/// A flight over the middle of the scene, low enough that several levels are visible.
struct Flight {
  const char* name;
  double elevation_deg;     ///< of the view direction below the horizon
  double height;            ///< above the surface, as a fraction of the distance at which lod 1 begins
  double ahead, aside, up;  ///< direction of the flight
};
constexpr Flight flights[] = {
    {"forward", 15, 0.25, 1, 0, 0}, {"aside", 15, 0.25, 0, 1, 0}, {"climb", 35, 0.5, 0, 0, 1}};

Vec3d above_surface(const ReferenceCaster& caster, double x, double y, double height) {
  const Vec3d from{x, y, caster.box().max[2] + 1};
  const double down = caster.first_hit(from, {0, 0, -1}).value_or(caster.box().max[2] - caster.box().min[2] + 1);
  return {x, y, from[2] - down + height};
}

/// Returns the highest point of the surface above or below the middle of the box. If there is no such point, returns a
/// place in the middle of the surface's area.
Vec3d middle_place(const ReferenceCaster& caster) {
  const TriangleBox& box = caster.box();
  const Vec3d centre = box.centre(), from{centre[0], centre[1], box.max[2] + 1};
  if (const auto down = caster.first_hit(from, {0, 0, -1})) return {from[0], from[1], from[2] - *down};
  const std::vector<Vec3d> places = visible_places(caster.triangles(), 3);
  return places[places.size() / 2];
}

void add_flight(const ReferenceCaster& caster, const AccuracyBenchRequest& request, const Flight& flight,
                std::vector<MotionPair>& out) {
  const TriangleBox& box = caster.box();
  const double lod1 = 2 / pixel_angle(fovy_deg, request.height), height = flight.height * lod1;
  const Vec3d forward = forward_at(flight.elevation_deg);
  const double level = std::hypot(forward[0], forward[1]);
  const Vec3d ahead{forward[0] / level, forward[1] / level, 0}, aside{ahead[1], -ahead[0], 0};
  const double nearest = height / std::sin((flight.elevation_deg + fovy_deg / 2) * std::numbers::pi / 180);
  const double step = motion_pixels * pixel_angle(fovy_deg, request.height) * nearest;
  const Vec3d middle = middle_place(caster);
  const Vec3d size = box.max - box.min, start = middle - ahead * (0.3 * std::min(size[0], size[1]));
  const Vec3d way = ahead * flight.ahead + aside * flight.aside + Vec3d{0, 0, flight.up};
  for (int i = 0; i < pairs_of_path; ++i) {
    const Vec3d eye = above_surface(caster, start[0], start[1], height) + way * (i * 0.11 * lod1);
    MotionPair pair{flight.name, double(i) / (pairs_of_path - 1), {}};
    for (int k = 0; k < 2; ++k) pair.cameras[k] = camera_at(eye + way * (k * step), forward, fovy_deg, request);
    out.push_back(pair);
  }
}

/// Adds the pairs of a zoom through one level. Rays are nearly parallel, so that much of the image changes its level at
/// once.
void add_zoom(const ReferenceCaster& caster, const AccuracyBenchRequest& request, std::vector<MotionPair>& out) {
  const Vec3d forward = forward_at(35);
  const Vec3d target = middle_place(caster);
  const double nearer = 1 - motion_pixels / (request.width / 2.0);
  for (int i = 0; i < pairs_of_path; ++i) {
    const double way = std::exp2(double(i) / pairs_of_path) / pixel_angle(accuracy_fovy_deg, request.height);
    MotionPair pair{"zoom", double(i) / (pairs_of_path - 1), {}};
    for (int k = 0; k < 2; ++k)
      pair.cameras[k] =
          camera_at(target - forward * (way * (k == 0 ? 1 : nearer)), forward, accuracy_fovy_deg, request);
    out.push_back(pair);
  }
}

using Shown = std::vector<Rgb>;

Shown shown_voxels(FrameRenderer& renderer, const CameraOptions& camera, LevelBlend blend) {
  View view{camera, ViewMode::lit, {false, {0, 0, 0, 0}}};
  view.level_blend = blend;
  return over(to_linear(renderer.render_complete(view).picture), 0);
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

/// Returns the maximum over the blocks of the mean difference minus the reference's mean difference.
double worst_block(const std::vector<double>& map, const std::vector<double>& reference, int width, int height) {
  double worst = 0;
  for (int y0 = 0; y0 + motion_block <= height; y0 += motion_block)
    for (int x0 = 0; x0 + motion_block <= width; x0 += motion_block) {
      double sum = 0;
      for (int y = y0; y < y0 + motion_block; ++y)
        for (int x = x0; x < x0 + motion_block; ++x) {
          const auto i = std::size_t(y) * std::size_t(width) + std::size_t(x);
          sum += map[i] - reference[i];
        }
      worst = std::max(worst, sum / (motion_block * motion_block));
    }
  return worst;
}

MotionRow look_at_pair(const ReferenceCaster& caster, const MotionPair& pair, const AccuracyBenchRequest& request,
                       FrameRenderer& renderer) {
  const int width = request.width, height = request.height;
  Shown triangles[2];
  std::uint64_t pixels = 0;
  for (int k = 0; k < 2; ++k) {
    const LinearPicture picture =
        caster.draw(reference_camera(pair.cameras[k], request.scene.parameters), request.samples, afternoon_light());
    if (k == 0) pixels = compared_pixels(picture);
    triangles[k] = over(on_screen(picture), 0);
  }
  expect_surface(request.scene.source, fmt::format("{} {:.1f}", pair.path, pair.at), pixels);
  const std::vector<double> expected = flip_map(triangles[0], triangles[1], width, height);
  MotionRow row{pair.path, pair.at, pixels, mean_of(expected), {}, {}};
  for (const auto& [blend, figures] :
       {std::pair{LevelBlend::off, &row.plain}, std::pair{LevelBlend::on, &row.blended}}) {
    const Shown first = shown_voxels(renderer, pair.cameras[0], blend),
                second = shown_voxels(renderer, pair.cameras[1], blend);
    const std::vector<double> map = flip_map(first, second, width, height);
    *figures = {mean_of(map), worst_block(map, expected, width, height), flip(triangles[0], first, width, height)};
  }
  return row;
}

}  // namespace

double MotionBench::worst_ratio(MotionFigures MotionRow::*way) const {
  double worst = 0;
  for (const MotionRow& row : rows)
    if (row.reference > 0) worst = std::max(worst, (row.*way).pair / row.reference);
  return worst;
}

double MotionBench::mean_still(MotionFigures MotionRow::*way) const {
  double sum = 0;
  for (const MotionRow& row : rows) sum += (row.*way).still;
  return rows.empty() ? 0 : sum / double(rows.size());
}

MotionBench bench_motion(const AccuracyBenchRequest& request, const AccuracyProgress& progress) {
  MotionBench bench{request.scene.source.string(),
                    request.scene.parameters.voxel_size_m,
                    request.samples,
                    request.width,
                    request.height,
                    request.scene.threads,
                    {}};
  const AccuracyScene scene(request, progress);
  FrameRenderer renderer(request.out / "scene.xml", scene.renderer);
  std::vector<MotionPair> pairs;
  for (const Flight& flight : flights) add_flight(scene.caster, request, flight, pairs);
  add_zoom(scene.caster, request, pairs);
  for (const MotionPair& pair : pairs) {
    progress(fmt::format("{} {:.1f}", pair.path, pair.at));
    bench.rows.push_back(look_at_pair(scene.caster, pair, request, renderer));
  }
  if (!renderer.problems().empty()) throw InputError(request.out, "", renderer.problems().front());
  return bench;
}

}  // namespace gigabake::bench
