// The members of LiveScene that follow a running bake.
#include <algorithm>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "viewer/live/live_scene.h"

namespace gigabake {
namespace {

constexpr double exchange_s = 0.02;  ///< time of an exchange between two frames

}  // namespace

/// Shows the changes of the watched bake. Returns false if the published scene should be shown. If the bake cannot be
/// read at this time, the shown scene stays, and the next call continues.
bool LiveScene::follow_bake() {
  if (!options_.watch) return false;
  const WatchedScene* watched = nullptr;
  try {
    watched = options_.watch->poll(changed_cells_);
  } catch (const std::exception& e) {
    const std::lock_guard lock(mutex_);
    if (!home_) problem_ = e.what();
    return is_watching_;
  }
  if (watched == nullptr) return false;
  if (watched->bake != watched_bake_)
    show_watched(*watched);
  else if (!changed_cells_.empty() && is_watching_)
    update_watched(*watched);
  return is_watching_;
}

void LiveScene::show_watched(const WatchedScene& watched) {
  watched_bake_ = watched.bake;
  exchanged_cells_.clear();
  std::vector<CellBox> boxes;
  for (std::size_t i = 0; i < watched.states.size(); ++i)
    boxes.push_back({window_of(watched.scene.cells[i]), watched.states[i]});
  open(
      [&] {
        release_renderer();
        return std::make_unique<FrameRenderer>(path_, watched.scene, options_.renderer);
      },
      std::move(boxes));
  stamp_ = {};  // scene.xml is opened at the end, also if it is unchanged
  options_.changed();
}

/// Begins to show new shards; their boxes stay until then. Draws the boxes of the last frames again.
void LiveScene::update_watched(const WatchedScene& watched) {
  std::vector<std::uint32_t> done;
  {
    const std::lock_guard lock(mutex_);
    bool are_boxes_changed = false;
    for (const std::uint32_t cell : changed_cells_) {
      if (watched.states[cell] == CellState::done) {
        done.push_back(cell);
      } else {
        boxes_[cell].state = watched.states[cell];
        are_boxes_changed = true;
      }
    }
    if (are_boxes_changed) redraw_boxes();
  }
  if (!done.empty()) renderer_->replace_shards(watched.scene.cells, done);
  exchanged_cells_.insert(exchanged_cells_.end(), done.begin(), done.end());
  options_.changed();
}

/// Begins to exchange the shown scene for its replacement within the same pools. Returns false if the replacement must
/// be opened again.
bool LiveScene::replace_in_place() {
  if (!renderer_ || is_watching_) return false;
  try {
    return renderer_->replace_scene();
  } catch (const std::exception& e) {
    const std::lock_guard lock(mutex_);
    problem_ = e.what();
    return true;  // the previous scene stays
  }
}

/// Continues an exchange of the renderer. At its end, all viewers render the new contents.
void LiveScene::exchange() {
  if (!renderer_ || !renderer_->has_exchange() || !renderer_->advance_exchange(exchange_s)) return;
  const CameraOptions home = renderer_->framed(options_.camera);
  ViewerInput look;
  std::string problem;
  try {
    look = options_.look(renderer_->scene().header());
  } catch (const std::exception& e) {
    problem = e.what();
  }
  {
    const std::lock_guard lock(mutex_);
    home_ = home;
    look_ = look;
    problem_ = problem;
    for (const std::uint32_t cell : std::exchange(exchanged_cells_, {}))
      if (cell < boxes_.size()) boxes_[cell].state = CellState::done;
    for (const auto& viewer : viewers_) {
      viewer->in_tiles.reset();
      apply_home(*viewer);
    }
  }
  options_.changed();
}

void LiveScene::redraw_boxes() {
  for (const auto& viewer : viewers_) redraw_boxes(*viewer);
}

/// Replaces the viewer's frame by one with the present boxes and previews. The pixels are copied once: the clean image
/// stays that of the earlier frame.
void LiveScene::redraw_boxes(Viewer& viewer) {
  if (!viewer.frame) return;
  const FramePtr last = viewer.frame;
  const auto clean = last->without_boxes ? last->without_boxes
                                         : std::shared_ptr<const Picture>(last, &last->frame.picture);  // shares it
  auto frame = std::make_shared<LiveFrame>(LiveFrame{
      last->number + 1, {*clean, last->frame.stats}, last->view, last->rays, {}, last->full, last->frames_per_s});
  if (has_boxes(viewer)) {
    frame->without_boxes = clean;
    add_boxes(viewer, *frame);
  }
  viewer.frame = std::move(frame);
  wake_viewers_.notify_all();
}

bool LiveScene::has_boxes(const Viewer& viewer) const {
  const auto is_open = [](const CellBox& box) { return box.state != CellState::done; };
  return !viewer.previews.empty() || std::any_of(boxes_.begin(), boxes_.end(), is_open);
}

/// Draws the boxes of the watched bake and the viewer's previews into the frame's image.
void LiveScene::add_boxes(const Viewer& viewer, LiveFrame& frame) const {
  Picture& picture = frame.frame.picture;
  draw_boxes(picture, frame.rays.camera, boxes_);
  draw_previews(picture, frame.rays, viewer.previews, renderer_ ? renderer_->pool() : callers_thread());
}

}  // namespace gigabake
