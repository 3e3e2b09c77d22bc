#include "bench/frame_bench.h"

#include <algorithm>
#include <chrono>
#include <numbers>

#include "bench/flight/flight_path.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t max_frames = 100000;

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Returns the box of the cells, and the height of the ground in its middle.
FlightArea measure_area(FrameRenderer& renderer) {
  constexpr int pixels = 33;
  const SceneHeader& scene = renderer.scene().header();
  const Box3i64& window = renderer.scene().totals().window;
  const Vec3d low = scene.lattice_origin_m + Vec3d(window.min) * scene.voxel_size_m,
              high = scene.lattice_origin_m + Vec3d(window.end) * scene.voxel_size_m, middle = (low + high) / 2,
              size = high - low;
  FlightArea area{{middle[0], middle[1], middle[2]}, std::max(size[0], size[1]), middle[2], scene.voxel_size_m};
  const Point<Scene> above{area.middle_m.x, area.middle_m.y, high[2] + area.width_m * 0.1};
  const Frame down = renderer.render_complete(view_from(above, {above.x, above.y, above.z - 1}, pixels, pixels));
  const float depth = down.picture.depth[pixels * (pixels / 2) + pixels / 2];
  if (depth < kernels::CastRay::no_depth) area.ground_m = above.z - double(depth) * area.voxel_m;
  return area;
}

struct NamedView {
  std::string name;
  View view;
};

std::vector<NamedView> fixed_views(const FlightArea& s, const FrameBenchRequest& request) {
  const auto looking = [&](const Point<Scene>& eye_m, const Point<Scene>& target_m) {
    return view_from(eye_m, target_m, request.width, request.height);
  };
  const double w = s.width_m, x = s.middle_m.x, y = s.middle_m.y, g = s.ground_m;
  return {{"nadir", looking({x, y, g + w}, {x, y, g})},
          {"oblique", looking({x + 0.6 * w, y - 0.6 * w, g + 0.5 * w}, {x, y, g})},
          {"grazing", looking({x + 0.1 * w, y - 0.45 * w, g + 0.06 * w}, {x, y + 0.4 * w, g})},
          {"ground level", looking({x, y, g + 20 * s.voxel_m}, {x + w, y + 0.3 * w, g + 20 * s.voxel_m})},
          {"inside", looking({x, y, g - 4 * s.voxel_m}, {x + w, y, g})}};
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

/// Renders one orbit. The eye moves a tenth of the scene's width in 20 of 200 frames.
FlightTimes bench_flight(const FlightArea& area, const FrameBenchRequest& request) {
  std::vector<View> views;
  for (int i = 0; i < request.flight_frames; ++i)
    views.push_back(orbit_view(area, 2 * std::numbers::pi * i / request.flight_frames, request.width, request.height));
  return fly(request.scene, request.renderer, views, {request.upload_s}, request.exact_frames);
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
  FlightArea area;
  {
    FrameRenderer scout(request.scene, request.renderer);
    area = measure_area(scout);
  }
  if (request.fixed_views)
    for (const NamedView& named : fixed_views(area, request)) bench.views.push_back(bench_view(named, request));
  if (request.flight_frames > 0) bench.flight = bench_flight(area, request);
  return bench;
}

}  // namespace gigabake::bench
