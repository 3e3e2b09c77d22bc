#include "viewer/live_scene.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

namespace gigabake {
namespace {

constexpr double look_every_s = 0.5, wait_for_pages_s = 0.005;

std::chrono::duration<double> seconds(double s) { return std::chrono::duration<double>(std::min(s, 3600.0)); }

}  // namespace

LiveScene::LiveScene(std::filesystem::path scene_path, Options options)
    : path_(std::move(scene_path)), options_(std::move(options)), thread_([this] { draw_all(); }) {}

LiveScene::~LiveScene() {
  stop();
  thread_.join();
}

void LiveScene::stop() {
  const std::lock_guard lock(mutex_);
  stop_ = true;
  wake_drawing_.notify_all();
  wake_viewers_.notify_all();
}

double LiveScene::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

// What viewers call.

std::optional<LiveScene::ViewerId> LiveScene::add_viewer(const Steering& first) {
  const std::lock_guard lock(mutex_);
  if (viewers_.size() >= options_.most_viewers) return std::nullopt;
  const auto viewer = std::make_shared<Viewer>();
  viewer->id = ViewerId(++ids_);
  viewer->settings = first;
  if (home_) show_home(*viewer);
  viewers_.push_back(viewer);
  wake_drawing_.notify_all();
  return viewer->id;
}

void LiveScene::remove_viewer(ViewerId id) {
  const std::lock_guard lock(mutex_);
  std::erase_if(viewers_, [&](const auto& v) { return v->id == id; });
  wake_viewers_.notify_all();
}

std::shared_ptr<LiveScene::Viewer> LiveScene::find(ViewerId id) const {
  const auto found = std::find_if(viewers_.begin(), viewers_.end(), [&](const auto& v) { return v->id == id; });
  return found == viewers_.end() ? nullptr : *found;
}

bool LiveScene::steer(ViewerId id, const Steering& steering) {
  const std::lock_guard lock(mutex_);
  const auto viewer = find(id);
  if (!viewer) return false;
  if (viewer->pilot) {
    viewer->pilot->steer(steering, now_s());
  } else if (steering.size) {
    viewer->settings.size = steering.size;
  }
  wake_drawing_.notify_all();
  return true;
}

std::optional<ViewerState> LiveScene::state(ViewerId id) const {
  const std::lock_guard lock(mutex_);
  const auto viewer = find(id);
  if (!viewer) return std::nullopt;
  ViewerState out;
  out.has_scene = home_.has_value();
  out.problem = problem_.empty() ? viewer->problem : problem_;
  out.problems = problems_;
  if (!viewer->pilot) return out;
  const Pilot& pilot = *viewer->pilot;
  out.resting = pilot.rests();
  out.pose = pilot.rig().pose();
  out.style = pilot.rig().style();
  out.speed_m_per_s = pilot.rig().speed_m_per_s();
  out.full_view = pilot.full_view();
  out.upload_s = pilot.upload_s();
  return out;
}

LiveScene::FramePtr LiveScene::wait_for_frame(ViewerId id, double timeout_s,
                                              const std::function<bool(const Viewer&)>& good) const {
  std::unique_lock lock(mutex_);
  FramePtr found;
  wake_viewers_.wait_for(lock, seconds(timeout_s), [&] {
    const auto viewer = find(id);
    if (viewer && viewer->frame && good(*viewer)) found = viewer->frame;
    return stop_ || !viewer || found;
  });
  return found;
}

LiveScene::FramePtr LiveScene::frame_after(ViewerId id, std::uint64_t after, double timeout_s) const {
  return wait_for_frame(id, timeout_s, [&](const Viewer& v) { return v.frame->number > after; });
}

LiveScene::FramePtr LiveScene::full_frame(ViewerId id, double timeout_s) const {
  return wait_for_frame(id, timeout_s, [&](const Viewer& v) {
    return v.pilot->rests() && v.problem.empty() && v.frame->full && v.frame->frame.stats.complete;
  });
}

bool LiveScene::has_scene() const {
  const std::lock_guard lock(mutex_);
  return home_.has_value();
}

// The thread that draws.

void LiveScene::draw_all() {
  for (;;) {
    reload_if_replaced();
    Pilot::Order order;
    double ask_again_s = HUGE_VAL;
    const auto viewer = next_order(order, ask_again_s);
    if (viewer) {
      draw(viewer, order);
      continue;
    }
    std::unique_lock lock(mutex_);
    if (stop_) return;
    wake_drawing_.wait_for(lock, seconds(std::clamp(ask_again_s - now_s(), 0.001, look_every_s)));
  }
}

void LiveScene::reload_if_replaced() {
  if (now_s() < looked_s_ + look_every_s) return;
  looked_s_ = now_s();
  const std::optional<FileStamp> stamp = stamp_of(path_);
  if (!stamp) return;
  if (*stamp == FileStamp{}) {
    const std::lock_guard lock(mutex_);
    if (!home_) problem_ = path_.string() + ": not there yet";
    return;
  }
  if (*stamp == stamp_) return;
  stamp_ = *stamp;
  reload();
  options_.changed();
}

void LiveScene::reload() {
  std::unique_ptr<FrameRenderer> renderer;
  CameraOptions home;
  std::string problem;
  try {
    renderer = std::make_unique<FrameRenderer>(path_, options_.renderer);
    home = renderer->framed(options_.camera);
  } catch (const std::exception& e) {
    problem = e.what();
  }
  const std::lock_guard lock(mutex_);
  problem_ = problem;
  if (!problem.empty()) return;
  renderer_ = std::move(renderer);
  home_ = home;
  for (const auto& viewer : viewers_) show_home(*viewer);
}

void LiveScene::show_home(Viewer& viewer) {
  viewer.problem.clear();
  if (viewer.pilot) {
    viewer.pilot->new_scene(*home_);
    return;
  }
  viewer.pilot.emplace(*home_, options_.frame_s);
  viewer.pilot->steer(viewer.settings, now_s());
}

std::shared_ptr<LiveScene::Viewer> LiveScene::next_order(Pilot::Order& order, double& ask_again_s) {
  const std::lock_guard lock(mutex_);
  if (stop_ || !renderer_) return nullptr;
  for (std::size_t i = 0; i < viewers_.size(); ++i) {
    const auto viewer = viewers_[i];
    if (!viewer->pilot) continue;
    if (const auto wanted = viewer->pilot->next(now_s())) {
      std::rotate(viewers_.begin(), viewers_.begin() + std::ptrdiff_t(i) + 1, viewers_.end());
      order = *wanted;
      return viewer;
    }
    ask_again_s = std::min(ask_again_s, viewer->pilot->ask_again_s());
  }
  return nullptr;
}

void LiveScene::draw(const std::shared_ptr<Viewer>& viewer, const Pilot::Order& order) {
  Frame frame;
  std::string problem;
  try {
    frame = renderer_->draw(order.view, order.upload_s);
  } catch (const std::exception& e) {
    problem = e.what();
  }
  const bool waits = problem.empty() && !frame.stats.complete && frame.stats.uploads == 0;
  const std::uint64_t problems = renderer_->problems().size();
  {
    std::unique_lock lock(mutex_);
    viewer->problem = problem;
    problems_ = problems;
    if (problem.empty()) {
      hand_over(*viewer, order, std::move(frame));
    } else {
      viewer->pilot->failed();
    }
    wake_viewers_.notify_all();
    // Pages are on their way: drawing the same again would only take their cores.
    if (waits && !stop_) wake_drawing_.wait_for(lock, seconds(wait_for_pages_s));
  }
  options_.changed();
}

void LiveScene::hand_over(Viewer& viewer, const Pilot::Order& order, Frame drawn) {
  const auto frame = std::make_shared<LiveFrame>();
  const double apart_s = now_s() - viewer.drawn_s;
  viewer.drawn_s = now_s();
  viewer.pilot->drawn(order, drawn.stats);
  frame->frame = std::move(drawn);
  frame->view = order.view;
  frame->full = order.full;
  frame->number = viewer.frame ? viewer.frame->number + 1 : 1;
  if (apart_s < 1) {
    const double before = viewer.frame ? viewer.frame->frames_per_s : 0;
    frame->frames_per_s = before > 0 ? 0.8 * before + 0.2 / apart_s : 1 / apart_s;
  }
  viewer.frame = frame;
}

}  // namespace gigabake
