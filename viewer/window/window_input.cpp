#include "viewer/window/window_input.h"

#include <GLFW/glfw3.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <imgui.h>
#include <map>
#include <utility>

namespace gigabake {
namespace {

constexpr double click_pixels = 4;  ///< a longer movement with a button pressed is a drag
constexpr double slow_share = 0.2, swing_heights_per_s = 0.3;

const std::map<int, std::array<double, 3>> walks{{GLFW_KEY_W, {1, 0, 0}}, {GLFW_KEY_S, {-1, 0, 0}},
                                                 {GLFW_KEY_D, {0, 1, 0}}, {GLFW_KEY_A, {0, -1, 0}},
                                                 {GLFW_KEY_E, {0, 0, 1}}, {GLFW_KEY_Q, {0, 0, -1}}};
const std::map<int, std::array<double, 2>> swings{{GLFW_KEY_RIGHT, {swing_heights_per_s, 0}},
                                                  {GLFW_KEY_LEFT, {-swing_heights_per_s, 0}},
                                                  {GLFW_KEY_UP, {0, swing_heights_per_s}},
                                                  {GLFW_KEY_DOWN, {0, -swing_heights_per_s}}};
const std::map<int, WindowCommand> commands{
    {GLFW_KEY_M, WindowCommand::next_mode},     {GLFW_KEY_O, WindowCommand::next_style},
    {GLFW_KEY_C, WindowCommand::measure},       {GLFW_KEY_P, WindowCommand::save_picture},
    {GLFW_KEY_R, WindowCommand::record},        {GLFW_KEY_F1, WindowCommand::toggle_panel},
    {GLFW_KEY_F2, WindowCommand::toggle_brush}, {GLFW_KEY_ENTER, WindowCommand::apply_edit},
    {GLFW_KEY_ESCAPE, WindowCommand::close}};
/// Commands by character, because the keys of these characters differ between keyboard layouts.
const std::map<unsigned, WindowCommand> commands_of_signs{{'+', WindowCommand::coarser},
                                                          {'=', WindowCommand::coarser},
                                                          {'-', WindowCommand::finer},
                                                          {'?', WindowCommand::toggle_keys}};

WindowInput& input_of(GLFWwindow* window) { return *static_cast<WindowInput*>(glfwGetWindowUserPointer(window)); }

template <std::size_t n>
std::array<double, n> total(const std::set<int>& held, const std::map<int, std::array<double, n>>& moves, bool slow) {
  std::array<double, n> sum{};
  for (const int key : held)
    if (const auto move = moves.find(key); move != moves.end())
      for (std::size_t k = 0; k < n; ++k) sum[k] += move->second[k] * (slow ? slow_share : 1);
  return sum;
}

}  // namespace

WindowInput::WindowInput(GLFWwindow* window) : window_(window) {
  glfwSetWindowUserPointer(window, this);
  glfwSetKeyCallback(
      window, [](GLFWwindow* w, int k, int, int action, int modifiers) { input_of(w).key(k, action, modifiers); });
  glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) { input_of(w).typed(character); });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int b, int action, int) { input_of(w).button(b, action); });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) { input_of(w).cursor(x, y); });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double notches) { input_of(w).scroll(notches); });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { input_of(w).touch(); });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { input_of(w).touch(); });
}

WindowInput::~WindowInput() { glfwSetWindowUserPointer(window_, nullptr); }

ViewerInput WindowInput::take_input() {
  ViewerInput out = std::exchange(pending_, {});
  if (!held_.empty() || sent_held_) {
    out.walk = total(held_, walks, slow_);
    out.swing = total(held_, swings, slow_);
  }
  sent_held_ = !held_.empty();
  return out;
}

std::vector<WindowCommand> WindowInput::take_commands() { return std::exchange(commands_, {}); }

std::vector<ViewKey> WindowInput::take_view_keys() { return std::exchange(view_keys_, {}); }

std::optional<std::array<double, 2>> WindowInput::mouse() const {
  if (glfwGetWindowAttrib(window_, GLFW_HOVERED) == GLFW_FALSE) return {};
  int width = 0, height = 0;
  double x = 0, y = 0;
  glfwGetWindowSize(window_, &width, &height);
  glfwGetCursorPos(window_, &x, &y);
  if (!(x >= 0 && x < width && y >= 0 && y < height)) return {};
  return std::array{x / width, y / height};
}

bool WindowInput::take_touched() { return std::exchange(touched_, false); }

void WindowInput::key(int key, int action, int modifiers) {
  touch();
  // For Shift itself, X11 reports the modifiers from before the event.
  const bool is_shift = key == GLFW_KEY_LEFT_SHIFT || key == GLFW_KEY_RIGHT_SHIFT;
  slow_ = is_shift ? action != GLFW_RELEASE : (modifiers & GLFW_MOD_SHIFT) != 0;
  repeats_ = action == GLFW_REPEAT;
  if (action == GLFW_RELEASE) held_.erase(key);
  if (action != GLFW_PRESS || ImGui::GetIO().WantTextInput) return;
  if (walks.count(key) != 0 || swings.count(key) != 0) held_.insert(key);
  if (key == GLFW_KEY_H) pending_.home = true;
  if (const auto command = commands.find(key); command != commands.end()) commands_.push_back(command->second);
  if (key >= GLFW_KEY_1 && key <= GLFW_KEY_9) view_keys_.push_back({key - GLFW_KEY_0, slow_});
}

void WindowInput::typed(unsigned character) {
  if (repeats_ || ImGui::GetIO().WantTextInput) return;
  if (const auto command = commands_of_signs.find(character); command != commands_of_signs.end())
    commands_.push_back(command->second);
}

/// Reports a click of the left button if the cursor has not moved.
void WindowInput::click(int action) {
  if (action == GLFW_PRESS) pressed_ = {x_, y_};
  if (action != GLFW_RELEASE || !pressed_) return;
  const std::array<double, 2> from = *std::exchange(pressed_, std::nullopt);
  if (std::hypot(x_ - from[0], y_ - from[1]) < click_pixels) commands_.push_back(WindowCommand::click);
}

void WindowInput::button(int button, int action) {
  touch();
  if (button == GLFW_MOUSE_BUTTON_LEFT && !ImGui::GetIO().WantCaptureMouse) click(action);
  if (action == GLFW_RELEASE) buttons_.erase(button);
  if (action == GLFW_PRESS && !ImGui::GetIO().WantCaptureMouse) buttons_.insert(button);
}

double WindowInput::window_height() const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  return std::max(height, 1);
}

void WindowInput::cursor(double x, double y) {
  touch();
  const double right = (x - x_) / window_height(), up = (y_ - y) / window_height();
  x_ = x;
  y_ = y;
  if (buttons_.empty()) return;
  std::array<double, 2>& sum = buttons_.count(GLFW_MOUSE_BUTTON_LEFT) != 0 && !slow_ ? pending_.turn : pending_.pan;
  sum[0] += right;
  sum[1] += up;
}

void WindowInput::scroll(double notches) {
  touch();
  if (!ImGui::GetIO().WantCaptureMouse) pending_.zoom += notches;
}

}  // namespace gigabake
