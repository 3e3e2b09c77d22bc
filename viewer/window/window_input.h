/// What mouse and keys of a window ask for.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <vector>

#include "viewer/live/pilot.h"

struct GLFWwindow;

namespace gigabake {

enum class WindowCommand {
  next_mode,
  next_style,
  coarser,
  finer,
  measure,
  save_picture,
  record,
  toggle_panel,
  toggle_keys,
  close
};

/// A digit: the view kept under it, or with Shift the one to keep there.
struct ViewKey {
  int digit;  ///< 1 … 9
  bool keeps;
};

/// Listens to a window from its construction on; make it before Dear ImGui takes its callbacks, which pass events on.
class WindowInput {
 public:
  explicit WindowInput(GLFWwindow* window);
  ~WindowInput();
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;

  /// All movements since the last call, and the keys held.
  Steering take_steering();
  /// Keys pressed since the last call.
  std::vector<WindowCommand> take_commands();
  std::vector<ViewKey> take_view_keys();
  bool holds() const { return !held_.empty(); }
  /// Where in the window the mouse is, right and down from 0 to 1; nothing where it is elsewhere.
  std::optional<std::array<double, 2>> mouse() const;
  /// Anything at all happened since the last call.
  bool take_touched();

  void key(int key, int action, int modifiers);
  /// After key(), if the key makes a character.
  void typed(unsigned character);
  void button(int button, int action);
  void cursor(double x, double y);
  void scroll(double notches);
  void touch() { touched_ = true; }

 private:
  double window_height() const;

  GLFWwindow* window_;
  Steering pending_;
  std::vector<WindowCommand> commands_;
  std::vector<ViewKey> view_keys_;
  std::set<int> held_;  ///< keys that walk or turn
  std::set<int> buttons_;
  double x_ = 0, y_ = 0;
  bool slow_ = false, repeats_ = false, told_held_ = false, touched_ = true;
};

}  // namespace gigabake
