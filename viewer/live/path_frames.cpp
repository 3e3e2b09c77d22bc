#include "viewer/live/path_frames.h"

#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <thread>

#include "core/base/error.h"
#include "viewer/pictures/frame_stats_json.h"

namespace gigabake {
namespace {

constexpr double max_frames = 1e6, full_upload_s = 1;
/// The maximum number of consecutive draws without an upload. More draws would not help: the missing data does not fit
/// in memory or cannot be read.
constexpr int max_idle_draws = 200;
constexpr auto wait_for_pages = std::chrono::milliseconds(2);

nlohmann::ordered_json triple(const std::optional<Point<Scene>>& p) {
  return p ? nlohmann::ordered_json{p->x, p->y, p->z} : nlohmann::ordered_json();
}

}  // namespace

std::vector<double> times_of_frames(const CameraPath& path, int frames) {
  if (frames < 1 || frames > max_frames) throw UsageError("frames", "expected 1 to 1000000");
  std::vector<double> out;
  for (int i = 0; i < frames; ++i)
    out.push_back(frames == 1 ? path.first_s()
                              : path.first_s() + (path.last_s() - path.first_s()) * (double(i) / (frames - 1)));
  return out;
}

std::vector<double> times_at_rate(const CameraPath& path, double frames_per_s) {
  if (!(frames_per_s > 0) || !std::isfinite(frames_per_s))
    throw UsageError("frames_per_s", "expected a positive number");
  const double intervals = std::floor((path.last_s() - path.first_s()) * frames_per_s + 1e-6);
  if (!(intervals < max_frames)) throw UsageError("frames_per_s", "more than 1000000 frames along this path");
  std::vector<double> out;
  for (double i = 0; i <= intervals; ++i) out.push_back(std::min(path.first_s() + i / frames_per_s, path.last_s()));
  return out;
}

std::filesystem::path numbered_file(const std::string& pattern, std::size_t number, const std::string& field) {
  const auto fail = [&] {
    throw UsageError(field, "expected a name with one %d or %04d for the number of the frame, such as frames/%04d.png");
  };
  const std::size_t at = pattern.find('%');
  if (at == std::string::npos || pattern.find('%', at + 1) != std::string::npos) fail();
  const std::size_t end = pattern.find('d', at);
  if (end == std::string::npos) fail();
  const std::string width = pattern.substr(at + 1, end - at - 1);
  const bool padded = width.size() == 2 && width[0] == '0' && width[1] >= '1' && width[1] <= '9';
  if (!width.empty() && !padded) fail();
  return fmt::format("{}{:0{}}{}", pattern.substr(0, at), number, padded ? width[1] - '0' : 1, pattern.substr(end + 1));
}

Frame draw_to_completion(FrameRenderer& renderer, const View& view, int& draws, const Progress& progress) {
  FrameStats sum;
  draws = 0;
  for (int idle = 0;;) {
    progress.advance(0);
    Frame frame = renderer.draw(view, full_upload_s);
    ++draws;
    sum.cast_s += frame.stats.cast_s;
    sum.upload_s += frame.stats.upload_s;
    sum.total_s += frame.stats.total_s;
    sum.uploads += frame.stats.uploads;
    idle = frame.stats.uploads > 0 ? 0 : idle + 1;
    if (frame.stats.complete || idle >= max_idle_draws) {
      frame.stats.cast_s = sum.cast_s;
      frame.stats.upload_s = sum.upload_s;
      frame.stats.total_s = sum.total_s;
      frame.stats.uploads = sum.uploads;
      return frame;
    }
    if (frame.stats.uploads > 0) continue;
    if (frame.stats.pages_loading > 0) idle = 0;
    std::this_thread::sleep_for(wait_for_pages);
  }
}

void draw_path(FrameRenderer& renderer, const CameraPath& path, const View& view, const std::vector<double>& times_s,
               Finish finish, double upload_s, const std::function<void(const PathFrame&, const Picture&)>& take,
               const Progress& progress) {
  progress.step("rendering", times_s.size(), "frame");
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    PathFrame out;
    View there = view;
    out.number = i;
    out.time_s = times_s[i];
    there.camera = out.camera = path.at(times_s[i], view.camera);
    Frame frame;
    try {
      out.draws = 1;
      frame = finish == Finish::live ? renderer.draw(there, upload_s)
                                     : draw_to_completion(renderer, there, out.draws, progress);
    } catch (const UsageError& e) {
      throw UsageError(fmt::format("{} (at {:g} s of the path)", e.what(), times_s[i]));
    }
    out.stats = frame.stats;
    take(out, frame.picture);
    progress.advance();
  }
}

std::string to_json(const std::vector<PathFrame>& frames) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PathFrame& f : frames)
    list.push_back({{"number", f.number},
                    {"time_s", f.time_s},
                    {"eye", triple(f.camera.eye_m)},
                    {"target", triple(f.camera.target_m)},
                    {"fovy_deg", f.camera.fovy_deg},
                    {"draws", f.draws},
                    {"stats", to_json(f.stats)}});
  return nlohmann::ordered_json{{"frames", std::move(list)}}.dump(1) + "\n";
}

}  // namespace gigabake
