#include "bench/flight/fly.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

namespace gigabake::bench {
namespace {

constexpr double max_psnr_db = 100;

/// A display that shows frames at multiples of its period.
class Ticks {
 public:
  explicit Ticks(double period_s)
      : period_(std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(period_s))) {}

  /// Waits for the next multiple of the period since the construction.
  void wait() {
    if (period_.count() <= 0) return;
    next_ += period_ * (1 + std::max<std::int64_t>(0, (Time::clock::now() - next_) / period_));
    std::this_thread::sleep_until(next_);
  }

 private:
  using Time = std::chrono::steady_clock::time_point;
  Time::duration period_;
  Time next_ = Time::clock::now();
};

struct ShownFrame {
  std::size_t view;
  Picture picture;
};

void compare_with_exact(FrameRenderer& renderer, const std::vector<View>& views, const std::vector<ShownFrame>& shown,
                        FlightTimes& times) {
  times.compared_frames = int(shown.size());
  times.worst_psnr_db = shown.empty() ? 0 : max_psnr_db;
  for (const ShownFrame& frame : shown) {
    const Picture exact = renderer.render_complete(views[frame.view]).picture;
    const double error = std::min(max_psnr_db, psnr_db(frame.picture, exact));
    times.mean_psnr_db += error;
    times.worst_psnr_db = std::min(times.worst_psnr_db, error);
    times.surface_pixels += surface_pixels_of(exact);
  }
  if (!shown.empty()) times.mean_psnr_db /= double(shown.size());
}

}  // namespace

double psnr_db(const Picture& a, const Picture& b) {
  double squared = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) squared += std::pow(double(a.rgba[i]) - double(b.rgba[i]), 2);
  if (squared == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * double(a.rgba.size()) / squared);
}

std::uint64_t surface_pixels_of(const Picture& picture) {
  return std::uint64_t(std::count_if(picture.depth.begin(), picture.depth.end(),
                                     [](float depth) { return depth != kernels::CastRay::no_depth; }));
}

double at_share(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, std::size_t(share * double(values.size())))];
}

FlightTimes fly(const std::filesystem::path& scene, const FrameRenderer::Options& options,
                const std::vector<View>& views, const FlightPace& pace, int exact_frames) {
  FrameRenderer renderer(scene, options);
  FlightTimes times;
  times.frames = int(views.size());
  std::vector<double> seconds;
  std::vector<ShownFrame> shown;
  const std::size_t every = std::max<std::size_t>(1, views.size() / std::size_t(std::max(1, exact_frames)));
  if (pace.starts_at_rest) renderer.render_complete(views.front());
  const std::uint64_t bytes_before = renderer.uploaded_bytes();
  std::size_t late = 0;
  Ticks ticks(pace.period_s);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i > 0) ticks.wait();
    Frame frame = renderer.draw(views[i], pace.upload_s);
    seconds.push_back(frame.stats.total_s);
    if (pace.period_s > 0 && frame.stats.total_s > pace.period_s) ++late;
    times.uploads += frame.stats.uploads;
    times.peak_bytes = std::max(times.peak_bytes, frame.stats.bytes_held);
    times.allowed_bytes = frame.stats.bytes_allowed;
    if (i % every == every - 1) shown.push_back({i, std::move(frame.picture)});
  }
  times.uploaded_bytes = renderer.uploaded_bytes() - bytes_before;
  times.late = double(late) / double(views.size());
  times.median_s = at_share(seconds, 0.5);
  times.p99_s = at_share(seconds, 0.99);
  times.worst_s = at_share(seconds, 1);
  compare_with_exact(renderer, views, shown, times);
  return times;
}

}  // namespace gigabake::bench
