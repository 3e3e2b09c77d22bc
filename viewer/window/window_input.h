/// Mouse and keyboard input of a window.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <vector>

#include "viewer/live/render_scheduler.h"

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
  toggle_brush,
  apply_edit,
  click,  ///< of the left button, without a movement
  close
};

/// A pressed digit key. It loads the bookmark of the digit, or saves the bookmark if Shift is held.
struct ViewKey {
  int digit;  ///< 1 … 9
  bool keeps;
};

/// A collector of a window's events. Create it before Dear ImGui installs its callbacks, because Dear ImGui's callbacks
/// call the previous callbacks.
class WindowInput {
 public:
  explicit WindowInput(GLFWwindow* window);
  ~WindowInput();
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;

  /// Returns all movements since the last call, and the held keys.
  ViewerInput take_input();
  /// Returns the commands of keys pressed since the last call.
  std::vector<WindowCommand> take_commands();
  std::vector<ViewKey> take_view_keys();
  bool holds() const { return !held_.empty(); }
  /// Returns the mouse position in the window, right and down from 0 to 1; nullopt if the mouse is outside.
  std::optional<std::array<double, 2>> mouse() const;
  /// Returns true if any event has occurred since the last call.
  bool take_touched();

  void key(int key, int action, int modifiers);
  /// Handles the character of a key press; called after key().
  void typed(unsigned character);
  void button(int button, int action);
  void cursor(double x, double y);
  void scroll(double notches);
  void touch() { touched_ = true; }

 private:
  double window_height() const;
  void click(int action);

  GLFWwindow* window_;
  ViewerInput pending_;
  std::vector<WindowCommand> commands_;
  std::vector<ViewKey> view_keys_;
  std::set<int> held_;  ///< keys that move or turn
  std::set<int> buttons_;
  double x_ = 0, y_ = 0;
  std::optional<std::array<double, 2>> pressed_;  ///< position of the cursor when the left button was pressed
  bool slow_ = false, repeats_ = false, sent_held_ = false, touched_ = true;
};

}  // namespace gigabake
