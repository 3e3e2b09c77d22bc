#include "viewer/window/window_edits.h"

#include <chrono>
#include <exception>

#include "viewer/window/edit_panel.h"

namespace gigabake {

std::string WindowEdits::place(const PickedPoint& at) {
  if (is_busy()) return "wait until the scene is changed";
  at_ = at.at_m;
  return preview();
}

std::string WindowEdits::preview() {
  try {
    scene_.preview(viewer_, at_ ? edits_of(brush_, *at_) : std::string());
    return {};
  } catch (const std::exception& e) {
    return e.what();
  }
}

/// Applies the edits, or undoes the last edit if they are empty, without blocking the window.
void WindowEdits::run(const std::string& edits, const std::string& done) {
  running_ = std::async(std::launch::async, [this, edits, done]() -> std::string {
    try {
      scene_.edit(viewer_, edits);
      return done;
    } catch (const std::exception& e) {
      return e.what();
    }
  });
}

void WindowEdits::apply() {
  if (!at_ || is_busy()) return;
  run(edits_of(brush_, *at_), "applied");
  at_.reset();
}

std::string WindowEdits::show() {
  const EditPanelAnswer answer = show_edit_panel(brush_, at_.has_value(), is_busy());
  if (answer.apply) {
    apply();
  } else if (answer.undo) {
    run({}, "the last edit is undone");
  } else if (answer.cancel) {
    at_.reset();
    return preview();
  } else if (answer.is_changed && at_) {
    return preview();
  }
  return {};
}

std::optional<std::string> WindowEdits::finished() {
  if (!is_busy() || running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return running_.get();
}

}  // namespace gigabake
