#include "viewer/live/live_scene.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

namespace gigabake {
namespace {

constexpr double check_interval_s = 0.5, watch_interval_s = 0.2, wait_for_pages_s = 0.005;
/// Time slice of a full-size image, and the interval at which its progress is shown.
constexpr double slice_s = 0.1, show_interval_s = 0.25;

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
  cancel_ = true;
  wake_drawing_.notify_all();
  wake_viewers_.notify_all();
}

double LiveScene::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

// Members for callers on any thread.

std::optional<LiveScene::ViewerId> LiveScene::add_viewer(const ViewerInput& first) {
  const std::lock_guard lock(mutex_);
  if (viewers_.size() >= options_.max_viewers) return std::nullopt;
  const auto viewer = std::make_shared<Viewer>();
  viewer->id = ViewerId(++ids_);
  viewer->settings = first;
  if (home_) apply_home(*viewer);
  viewers_.push_back(viewer);
  wake_drawing_.notify_all();
  return viewer->id;
}

void LiveScene::remove_viewer(ViewerId id) {
  const std::lock_guard lock(mutex_);
  if (const auto viewer = find(id); viewer && viewer.get() == rendered_viewer_) cancel_ = true;
  std::erase_if(viewers_, [&](const auto& v) { return v->id == id; });
  wake_viewers_.notify_all();
}

std::shared_ptr<LiveScene::Viewer> LiveScene::find(ViewerId id) const {
  const auto found = std::find_if(viewers_.begin(), viewers_.end(), [&](const auto& v) { return v->id == id; });
  return found == viewers_.end() ? nullptr : *found;
}

bool LiveScene::steer(ViewerId id, const ViewerInput& input) {
  const std::lock_guard lock(mutex_);
  const auto viewer = find(id);
  if (!viewer) return false;
  if (viewer->scheduler) {
    viewer->scheduler->steer(with_sun(input), now_s());
    if (viewer->scheduler->is_stale()) (viewer.get() == rendered_viewer_ ? cancel_ : yield_) = true;
  } else if (input.size) {
    viewer->settings.size = input.size;
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
  out.is_watching = is_watching_;
  out.has_place = place_.has_value();
  out.problem = problem_.empty() ? viewer->problem : problem_;
  out.problems = problems_;
  out.uploads = uploads_;
  if (!viewer->scheduler) return out;
  const RenderScheduler& scheduler = *viewer->scheduler;
  out.resting = scheduler.rests();
  out.drawn = viewer->drawn_share;
  out.pose = scheduler.controller().pose();
  out.style = scheduler.controller().style();
  out.speed_m_per_s = scheduler.controller().speed_m_per_s();
  out.full_view = scheduler.full_view();
  out.upload_s = scheduler.upload_s();
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
    return v.scheduler->rests() && v.problem.empty() && v.frame->full && v.frame->frame.stats.complete;
  });
}

std::optional<CellFacts> LiveScene::facts_at(ViewerId id, double right, double down) const {
  std::optional<std::uint32_t> cell;
  {
    const std::lock_guard lock(mutex_);
    const auto viewer = find(id);
    if (!is_watching_ || !viewer || !viewer->frame) return std::nullopt;
    cell = picked_cell(viewer->frame->frame.picture, viewer->frame->rays.camera, boxes_, right, down);
  }
  if (!cell) return std::nullopt;
  return options_.watch->facts(*cell);
}

bool LiveScene::has_scene() const {
  const std::lock_guard lock(mutex_);
  return home_.has_value();
}

// Members of the rendering thread.

void LiveScene::draw_all() {
  for (;;) {
    reload_if_replaced();
    exchange();
    RenderScheduler::RenderRequest order;
    double next_call_s = HUGE_VAL;
    const auto viewer = next_order(order, next_call_s);
    if (viewer) {
      draw(viewer, order);
      continue;
    }
    std::unique_lock lock(mutex_);
    if (stop_) return;
    const double max_wait_s = renderer_ && renderer_->has_exchange() ? wait_for_pages_s : watch_interval_s;
    wake_drawing_.wait_for(lock, seconds(std::clamp(next_call_s - now_s(), 0.001, max_wait_s)));
  }
}

void LiveScene::reload_if_replaced() {
  if (!is_edited_.exchange(false) && now_s() < checked_s_ + (options_.watch ? watch_interval_s : check_interval_s))
    return;
  checked_s_ = now_s();
  if (follow_bake()) return;
  const std::optional<FileStamp> stamp = stamp_of(path_);
  if (!stamp) return;
  if (*stamp == FileStamp{}) {
    const std::lock_guard lock(mutex_);
    if (!home_) problem_ = path_.string() + ": does not exist yet";
    return;
  }
  if (*stamp == stamp_) return;
  stamp_ = *stamp;
  if (replace_in_place()) return;
  open(
      [this] {
        const PagedScene readable(path_);  // if it throws, the previous scene stays
        release_renderer();
        return std::make_unique<FrameRenderer>(path_, options_.renderer);
      },
      {});
  options_.changed();
}

/// Opens a scene by `make` and shows it from the same position, with the boxes of a watched bake.
void LiveScene::open(const std::function<std::unique_ptr<FrameRenderer>()>& make, std::vector<CellBox> boxes) {
  std::unique_ptr<FrameRenderer> renderer;
  CameraOptions home;
  ViewerInput look;
  std::string problem;
  try {
    renderer = make();
    home = renderer->framed(options_.camera);
    look = options_.look(renderer->scene().header());
  } catch (const std::exception& e) {
    problem = e.what();
  }
  const std::lock_guard lock(mutex_);
  problem_ = problem;
  is_watching_ = problem.empty() && !boxes.empty();
  boxes_ = is_watching_ ? std::move(boxes) : std::vector<CellBox>();
  if (!problem.empty()) return;
  renderer_ = std::move(renderer);
  home_ = home;
  look_ = look;
  place_ = renderer_->scene().header().origin;
  for (const auto& viewer : viewers_) apply_home(*viewer);
}

/// Frees the pools of the previous scene, so that two sets of pools never exist at the same time.
void LiveScene::release_renderer() {
  const std::lock_guard lock(mutex_);
  for (const auto& viewer : viewers_) viewer->in_tiles.reset();
  renderer_.reset();
}

void LiveScene::apply_home(Viewer& viewer) {
  viewer.problem.clear();
  if (viewer.scheduler) {
    viewer.scheduler->new_scene(*home_);
    return;
  }
  viewer.scheduler.emplace(*home_, options_.frame_s);
  viewer.scheduler->steer(look_, now_s());
  viewer.scheduler->steer(with_sun(viewer.settings), now_s());
}

/// Returns the input, with `sun` computed from `time` if the scene has an origin on the earth.
ViewerInput LiveScene::with_sun(ViewerInput input) const {
  if (input.time && place_) {
    const SunDirection sun = sun_at(*place_, *input.time);
    input.sun = {sun.azimuth_deg, sun.elevation_deg};
  }
  return input;
}

std::shared_ptr<LiveScene::Viewer> LiveScene::next_order(RenderScheduler::RenderRequest& order, double& next_call_s) {
  const std::lock_guard lock(mutex_);
  if (stop_ || !renderer_) return nullptr;
  for (std::size_t i = 0; i < viewers_.size(); ++i) {
    const auto viewer = viewers_[i];
    if (!viewer->scheduler) continue;
    if (const auto requested = viewer->scheduler->next(now_s())) {
      std::rotate(viewers_.begin(), viewers_.begin() + std::ptrdiff_t(i) + 1, viewers_.end());
      order = *requested;
      rendered_viewer_ = order.moving ? nullptr : viewer.get();
      cancel_ = yield_ = false;
      return viewer;
    }
    next_call_s = std::min(next_call_s, viewer->scheduler->next_call_s());
  }
  return nullptr;
}

/// Renders the request; returns nullopt if there is no new image to show.
std::optional<Frame> LiveScene::render_request(Viewer& viewer, const RenderScheduler::RenderRequest& order) {
  if (order.in_tiles) return slice(viewer, order);
  viewer.in_tiles.reset();
  Frame frame =
      renderer_->render_preview(order.view, {order.upload_s, order.roots_s, [this] { return cancel_.load(); }});
  if (cancel_) return std::nullopt;
  return frame;
}

std::optional<Frame> LiveScene::slice(Viewer& viewer, const RenderScheduler::RenderRequest& order) {
  if (!viewer.in_tiles || viewer.in_tiles_pose != order.pose) {
    const bool sketched = viewer.frame && viewer.frame_pose == order.pose;
    viewer.in_tiles = renderer_->begin(order.view, sketched ? &viewer.frame->clean_picture() : nullptr);
    viewer.in_tiles_pose = order.pose;
  }
  ProgressiveFrame& work = *viewer.in_tiles;
  const double end_s = now_s() + slice_s;
  renderer_->resume(
      work, [&] { return yield_ || now_s() >= end_s; }, [this] { return cancel_.load(); });
  if (work.is_complete()) {
    Frame frame{std::move(work.picture), work.stats};
    viewer.in_tiles.reset();
    return frame;
  }
  if (cancel_ || now_s() < viewer.drawn_s + show_interval_s) return std::nullopt;
  return Frame{work.picture, work.stats};
}

void LiveScene::draw(const std::shared_ptr<Viewer>& viewer, const RenderScheduler::RenderRequest& order) {
  std::optional<Frame> frame;
  PictureRays rays;
  std::string problem;
  try {
    frame = render_request(*viewer, order);
    if (frame) rays = rays_of(order.view.camera);
  } catch (const std::exception& e) {
    problem = e.what();
  }
  const bool waits = frame && !order.in_tiles && !frame->stats.complete && frame->stats.uploads == 0;
  const std::uint64_t problems = renderer_->problems().size(), uploads = renderer_->uploads();
  {
    std::unique_lock lock(mutex_);
    rendered_viewer_ = nullptr;
    viewer->problem = problem;
    problems_ = problems;
    uploads_ = uploads;
    const auto& work = viewer->in_tiles;
    viewer->drawn_share = work ? double(work->done) / double(work->tiles.size()) : frame && frame->stats.complete;
    if (!problem.empty()) {
      viewer->scheduler->failed();
    } else if (frame) {
      publish_frame(*viewer, order, std::move(*frame), rays);
    }
    wake_viewers_.notify_all();
    // The missing pages are being read. Rendering again before they arrive would only take CPU time from the readers.
    if (waits && !stop_) wake_drawing_.wait_for(lock, seconds(wait_for_pages_s));
  }
  options_.changed();
}

PictureRays LiveScene::rays_of(const CameraOptions& camera) const {
  const SceneHeader& scene = renderer_->scene().header();
  return {renderer_->rays_of(camera), scene.lattice_origin_m, scene.voxel_size_m, scene.origin};
}

void LiveScene::publish_frame(Viewer& viewer, const RenderScheduler::RenderRequest& order, Frame drawn,
                              const PictureRays& rays) {
  const auto frame = std::make_shared<LiveFrame>();
  const double apart_s = now_s() - viewer.drawn_s;
  viewer.drawn_s = now_s();
  viewer.scheduler->drawn(order, drawn.stats);
  frame->frame = std::move(drawn);
  frame->view = order.view;
  frame->rays = rays;
  frame->full = order.full;
  if (has_boxes(viewer)) {
    frame->without_boxes = std::make_shared<const Picture>(frame->frame.picture);
    add_boxes(viewer, *frame);
  }
  frame->number = viewer.frame ? viewer.frame->number + 1 : 1;
  if (apart_s < 1) {
    const double before = viewer.frame ? viewer.frame->frames_per_s : 0;
    frame->frames_per_s = before > 0 ? 0.8 * before + 0.2 / apart_s : 1 / apart_s;
  }
  viewer.frame = frame;
  viewer.frame_pose = order.pose;
}

}  // namespace gigabake
