#include "bench/frame_bench.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t max_frames = 100000;

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double at_share(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, std::size_t(share * double(values.size())))];
}

/// Returns the PSNR of the sRGB bytes; infinite if they are equal.
double psnr_db(const Picture& a, const Picture& b) {
  double squared = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) squared += std::pow(double(a.rgba[i]) - double(b.rgba[i]), 2);
  if (squared == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * double(a.rgba.size()) / squared);
}

/// The middle and the width of the scene, and the height of the ground in its middle.
struct Stage {
  Point<Scene> middle_m;
  double width_m = 0, ground_m = 0, voxel_m = 0;
};

View looking(const Point<Scene>& eye_m, const Point<Scene>& target_m, const FrameBenchRequest& request) {
  View view;
  view.camera.eye_m = eye_m;
  view.camera.target_m = target_m;
  view.camera.width = request.width;
  view.camera.height = request.height;
  return view;
}

Stage measure(FrameRenderer& renderer, const FrameBenchRequest& request) {
  const SceneHeader& scene = renderer.scene().header();
  const Box3i64& window = renderer.scene().totals().window;
  const Vec3d low = scene.lattice_origin_m + Vec3d(window.min) * scene.voxel_size_m,
              high = scene.lattice_origin_m + Vec3d(window.end) * scene.voxel_size_m, middle = (low + high) / 2,
              size = high - low;
  Stage stage{{middle[0], middle[1], middle[2]}, std::max(size[0], size[1]), middle[2], scene.voxel_size_m};
  const Point<Scene> above{stage.middle_m.x, stage.middle_m.y, high[2] + stage.width_m * 0.1};
  FrameBenchRequest small = request;
  small.width = small.height = 33;
  const Frame down = renderer.render_complete(looking(above, {above.x, above.y, above.z - 1}, small));
  const float depth = down.picture.depth[33 * 16 + 16];
  if (depth < kernels::CastRay::no_depth) stage.ground_m = above.z - double(depth) * stage.voxel_m;
  return stage;
}

struct NamedView {
  std::string name;
  View view;
};

std::vector<NamedView> fixed_views(const Stage& s, const FrameBenchRequest& request) {
  const double w = s.width_m, x = s.middle_m.x, y = s.middle_m.y, g = s.ground_m;
  return {{"nadir", looking({x, y, g + w}, {x, y, g}, request)},
          {"oblique", looking({x + 0.6 * w, y - 0.6 * w, g + 0.5 * w}, {x, y, g}, request)},
          {"grazing", looking({x + 0.1 * w, y - 0.45 * w, g + 0.06 * w}, {x, y + 0.4 * w, g}, request)},
          {"ground level", looking({x, y, g + 20 * s.voxel_m}, {x + w, y + 0.3 * w, g + 20 * s.voxel_m}, request)},
          {"inside", looking({x, y, g - 4 * s.voxel_m}, {x + w, y, g}, request)}};
}

std::uint64_t surface_pixels_of(const Picture& picture) {
  return std::uint64_t(std::count_if(picture.depth.begin(), picture.depth.end(),
                                     [](float depth) { return depth != kernels::CastRay::no_depth; }));
}

FrameBenchView bench_view(const NamedView& named, const FrameBenchRequest& request) {
  FrameRenderer renderer(request.scene, request.renderer);
  FrameBenchView result;
  result.view = named.name;
  Picture first;
  const auto start = Clock::now();
  Frame frame;
  while (!frame.stats.complete && result.frames_to_complete < max_frames) {
    frame = renderer.draw(named.view, request.upload_s);
    ++result.frames_to_complete;
    result.uploads += frame.stats.uploads;
    if (first.rgba.empty() && frame.stats.uploads > 0) first = frame.picture;
  }
  result.complete_s = since(start);
  result.first_psnr_db = first.rgba.empty() ? 0 : psnr_db(first, frame.picture);
  std::vector<double> times, casts;
  for (int i = 0; i < request.repeats; ++i) {
    const Frame again = renderer.draw(named.view, request.upload_s);
    times.push_back(again.stats.total_s);
    casts.push_back(again.stats.cast_s);
  }
  result.best_s = at_share(times, 0);
  result.median_s = at_share(times, 0.5);
  result.best_cast_s = at_share(casts, 0);
  const Picture exact = renderer.render_complete(named.view).picture;
  result.same_as_exact = exact.rgba == frame.picture.rgba;
  result.surface_pixels = surface_pixels_of(exact);
  return result;
}

/// Returns a view of the flight around the middle; its height varies. The eye moves a tenth of the scene's width in 20
/// frames.
View on_flight(const Stage& s, double share, const FrameBenchRequest& request) {
  const double angle = 2 * std::numbers::pi * share, w = s.width_m;
  const double up = 0.05 + 0.1 * (1 + std::cos(3 * angle));
  return looking(
      {s.middle_m.x + 0.4 * w * std::cos(angle), s.middle_m.y + 0.4 * w * std::sin(angle), s.ground_m + up * w},
      {s.middle_m.x + 0.2 * w * std::cos(angle + 1), s.middle_m.y + 0.2 * w * std::sin(angle + 1), s.ground_m},
      request);
}

FlightBench bench_flight(const Stage& stage, const FrameBenchRequest& request) {
  FrameRenderer renderer(request.scene, request.renderer), exact(request.scene, request.renderer);
  FlightBench flight;
  flight.frames = request.flight_frames;
  std::vector<double> times, errors;
  const int every = std::max(1, request.flight_frames / std::max(1, request.exact_frames));
  for (int i = 0; i < request.flight_frames; ++i) {
    const View view = on_flight(stage, double(i) / request.flight_frames, request);
    const Frame frame = renderer.draw(view, request.upload_s);
    times.push_back(frame.stats.total_s);
    flight.uploads += frame.stats.uploads;
    flight.peak_bytes = std::max(flight.peak_bytes, frame.stats.bytes_held);
    flight.allowed_bytes = frame.stats.bytes_allowed;
    if (i % every != every - 1) continue;
    const Picture picture = exact.render_complete(view).picture;
    errors.push_back(std::min(100.0, psnr_db(frame.picture, picture)));
    flight.surface_pixels += surface_pixels_of(picture);
  }
  flight.median_s = at_share(times, 0.5);
  flight.p99_s = at_share(times, 0.99);
  flight.worst_s = at_share(times, 1);
  for (const double error : errors) flight.mean_psnr_db += error / double(errors.size());
  flight.worst_psnr_db = errors.empty() ? 0 : at_share(errors, 0);
  return flight;
}

}  // namespace

std::uint64_t FrameBench::surface_pixels() const {
  std::uint64_t pixels = flight.surface_pixels;
  for (const FrameBenchView& view : views) pixels += view.surface_pixels;
  return pixels;
}

bool FrameBench::failed() const {
  return surface_pixels() == 0 ||
         std::any_of(views.begin(), views.end(), [](const FrameBenchView& v) { return !v.same_as_exact; });
}

FrameBench bench_frames(const FrameBenchRequest& request) {
  FrameBench bench;
  bench.backend = request.renderer.cuda_device ? "cuda" : "cpu";
  bench.width = request.width;
  bench.height = request.height;
  Stage stage;
  {
    FrameRenderer scout(request.scene, request.renderer);
    stage = measure(scout, request);
  }
  if (request.fixed_views)
    for (const NamedView& named : fixed_views(stage, request)) bench.views.push_back(bench_view(named, request));
  if (request.flight_frames > 0) bench.flight = bench_flight(stage, request);
  return bench;
}

}  // namespace gigabake::bench
