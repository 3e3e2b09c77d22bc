// The members of LiveScene that edit the scene.
#include <string>
#include <utility>

#include "viewer/live/live_scene.h"

namespace gigabake {

bool LiveScene::preview(ViewerId id, const std::string& edits) {
  if (!may_edit()) return false;
  const FramePtr shown = frame_after(id, 0, 0);
  if (!shown) return false;
  EditPreviews previews;
  if (!edits.empty()) previews = options_.editor->preview(edits, shown->rays);
  {
    const std::lock_guard lock(mutex_);
    const auto viewer = find(id);
    if (!viewer) return false;
    viewer->previews = std::move(previews);
    redraw_boxes(*viewer);
  }
  options_.changed();
  return true;
}

void LiveScene::edit(ViewerId id, const std::string& edits) {
  if (edits.empty())
    options_.editor->undo();
  else
    options_.editor->apply(edits);
  preview(id, {});
  is_edited_ = true;
  const std::lock_guard lock(mutex_);
  wake_drawing_.notify_all();
}

}  // namespace gigabake
