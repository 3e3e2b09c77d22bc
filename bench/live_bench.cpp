#include "bench/live_bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "core/base/error.h"
#include "viewer/live/live_scene.h"

namespace gigabake::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double timeout_s = 600;

double elapsed_s(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Seen {
  double at_s;
  LiveScene::FramePtr frame;
};

LiveBenchFrame compared(const Seen& seen, const Picture& last) {
  const Picture& shown = seen.frame->frame.picture;
  LiveBenchFrame out{seen.at_s, shown.width, shown.height, 0, 0};
  std::uint64_t surface = 0, holes = 0;
  double error = 0;
  for (int y = 0; y < last.height; ++y)
    for (int x = 0; x < last.width; ++x) {
      const std::size_t there = std::size_t(y) * std::size_t(last.width) + std::size_t(x);
      const std::size_t here = std::size_t(y * shown.height / last.height) * std::size_t(shown.width) +
                               std::size_t(x * shown.width / last.width);
      for (std::size_t k = 0; k < 3; ++k)
        error += std::abs(double(last.rgba[4 * there + k]) - double(shown.rgba[4 * here + k])) / 3;
      if (last.depth[there] == kernels::CastRay::no_depth) continue;
      ++surface;
      holes += shown.depth[here] == kernels::CastRay::no_depth ? 1 : 0;
    }
  out.holes = surface > 0 ? double(holes) / double(surface) : 0;
  out.mean_error = error / double(last.depth.size());
  return out;
}

/// Returns all frames until the viewer is at rest; the last is the frame at rest.
std::vector<Seen> watch_until_rest(LiveScene& scene, LiveScene::ViewerId viewer, Clock::time_point start) {
  std::vector<Seen> all;
  for (;;) {
    const auto frame = scene.frame_after(viewer, all.empty() ? 0 : all.back().frame->number, timeout_s);
    if (!frame) throw InputError("live", "", "no image arrived within ten minutes");
    all.push_back({elapsed_s(start), frame});
    if (scene.full_frame(viewer, 0) == frame) return all;
  }
}

void turn(LiveScene& scene, LiveScene::ViewerId viewer) {
  ViewerInput steering;
  steering.turn = {0.05, 0};
  scene.steer(viewer, steering);
}

/// Returns the time from a movement to an image from the new pose. The movement follows an earlier movement after a
/// pause, so that a full frame is in progress.
double answer_s(LiveScene& scene, LiveScene::ViewerId viewer, double pause_s) {
  turn(scene, viewer);
  std::this_thread::sleep_for(std::chrono::duration<double>(RenderScheduler::rest_s + pause_s));
  const auto start = Clock::now();
  turn(scene, viewer);
  const auto pose = scene.state(viewer)->pose;
  for (std::uint64_t after = 0;;) {
    const auto frame = scene.frame_after(viewer, after, timeout_s);
    if (!frame) throw InputError("live", "", "no image arrived within ten minutes");
    if (frame->view.camera.eye_m == pose.eye_m) return elapsed_s(start);
    after = frame->number;
  }
}

}  // namespace

LiveBench bench_live(const LiveBenchRequest& request) {
  LiveBench out;
  out.width = request.width;
  out.height = request.height;
  LiveScene::Options options;
  options.renderer = request.renderer;
  options.camera.width = request.width;
  options.camera.height = request.height;
  auto start = Clock::now();
  std::optional<LiveScene> scene(std::in_place, request.scene, options);
  const auto viewer = scene->add_viewer().value();
  const std::vector<Seen> seen = watch_until_rest(*scene, viewer, start);
  const LiveFrame& last = *seen.back().frame;
  out.rest_s = seen.back().at_s;
  for (const Seen& one : seen) out.frames.push_back(compared(one, last.frame.picture));
  for (const float depth : last.frame.picture.depth) out.surface_pixels += depth != kernels::CastRay::no_depth ? 1 : 0;
  std::vector<double> answers;
  for (int i = 0; i < request.movements; ++i) answers.push_back(answer_s(*scene, viewer, 0.1 + 0.07 * i));
  std::sort(answers.begin(), answers.end());
  out.median_answer_s = answers[answers.size() / 2];
  out.worst_answer_s = answers.back();
  turn(*scene, viewer);
  std::this_thread::sleep_for(std::chrono::duration<double>(RenderScheduler::rest_s + 0.2));
  start = Clock::now();
  scene.reset();
  out.close_s = elapsed_s(start);
  start = Clock::now();
  FrameRenderer renderer(request.scene, request.renderer);
  out.same_as_rendered = renderer.render_complete(last.view).picture.rgba == last.frame.picture.rgba;
  out.render_s = elapsed_s(start);
  return out;
}

}  // namespace gigabake::bench
