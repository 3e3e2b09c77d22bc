/// The brush of a window: its place, its preview, and the edit that is being applied.
#pragma once

#include <future>
#include <optional>
#include <string>

#include "viewer/live/edit_brush.h"
#include "viewer/live/live_scene.h"

namespace gigabake {

class WindowEdits {
 public:
  /// Borrows the scene.
  WindowEdits(LiveScene& scene, LiveScene::ViewerId viewer) : scene_(scene), viewer_(viewer) {}

  /// Places the brush and shows its preview. Returns the reason if it cannot be shown, else an empty text.
  std::string place(const PickedPoint& at);
  /// Begins to apply the placed brush; does nothing without a place, or while an edit is applied.
  void apply();
  /// Shows the panel and performs its actions. Returns a message, or an empty text.
  std::string show();
  /// Returns a message once the edit in progress has ended.
  std::optional<std::string> finished();

 private:
  bool is_busy() const { return running_.valid(); }
  std::string preview();
  void run(const std::string& edits, const std::string& done);

  LiveScene& scene_;
  const LiveScene::ViewerId viewer_;
  EditBrush brush_;
  std::optional<Point<Scene>> at_;
  std::future<std::string> running_;  ///< its message
};

}  // namespace gigabake
