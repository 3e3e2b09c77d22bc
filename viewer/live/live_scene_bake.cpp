// The members of LiveScene that follow a running bake.
#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "viewer/live/live_scene.h"

namespace gigabake {

/// Shows the changes of the watched bake. Returns false if the published scene should be shown.
bool LiveScene::follow_bake() {
  if (!options_.watch) return false;
  const WatchedScene* watched = nullptr;
  try {
    watched = options_.watch->poll(changed_cells_);
  } catch (const std::exception& e) {
    const std::lock_guard lock(mutex_);
    if (!home_) problem_ = e.what();
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

/// Shows new shards. The box of a new cell stays until its image is rendered. If only states have changed, draws the
/// boxes of the last frames again.
void LiveScene::update_watched(const WatchedScene& watched) {
  std::vector<std::uint32_t> replaced;
  {
    const std::lock_guard lock(mutex_);
    for (const std::uint32_t cell : changed_cells_) {
      if (watched.states[cell] == CellState::done) replaced.push_back(cell);
      boxes_[cell].state = watched.states[cell];
    }
    if (replaced.empty()) redraw_boxes();
  }
  if (!replaced.empty()) show_replaced(watched, replaced);
  options_.changed();
}

void LiveScene::redraw_boxes() {
  for (const auto& viewer : viewers_) {
    if (!viewer->frame) continue;
    auto frame = std::make_shared<LiveFrame>(*viewer->frame);
    ++frame->number;
    add_boxes(*frame);
    viewer->frame = std::move(frame);
  }
  wake_viewers_.notify_all();
}

void LiveScene::show_replaced(const WatchedScene& watched, const std::vector<std::uint32_t>& cells) {
  {
    const std::lock_guard lock(mutex_);
    for (const auto& viewer : viewers_) {
      viewer->in_tiles.reset();
      if (viewer->scheduler) viewer->scheduler->new_scene(*home_);
    }
  }
  renderer_->replace_shards(watched.scene.cells, cells);
}

/// Draws the boxes of the watched bake into the frame's image.
void LiveScene::add_boxes(LiveFrame& frame) const {
  Picture& picture = frame.frame.picture;
  if (frame.without_boxes) picture = *frame.without_boxes;
  frame.without_boxes = nullptr;
  const auto is_open = [](const CellBox& box) { return box.state != CellState::done; };
  if (std::none_of(boxes_.begin(), boxes_.end(), is_open)) return;
  frame.without_boxes = std::make_shared<const Picture>(picture);
  draw_boxes(picture, frame.rays.camera, boxes_);
}

}  // namespace gigabake
