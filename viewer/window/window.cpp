#include "viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <algorithm>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl2.h>
#include <cmath>
#include <fmt/format.h>
#include <imgui.h>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/base/quote.h"
#include "format/system/publish.h"
#include "viewer/live/bookmarks.h"
#include "viewer/live/camera_path.h"
#include "viewer/pictures/image_files.h"
#include "viewer/window/panel.h"
#include "viewer/window/screen_image.h"
#include "viewer/window/window_edits.h"
#include "viewer/window/window_input.h"

namespace gigabake {
namespace {

constexpr double held_poll_s = 1.0 / 60, idle_poll_s = 0.5;
/// The number of redraws after an event. Dear ImGui reacts one frame later, and its layout settles in the frame after
/// that.
constexpr int redraws_after_event = 3;
constexpr int max_files = 9999;
/// Time for which the window's title shows the last message.
constexpr double message_s = 15;

[[noreturn]] void fail_at(const char* what) {
  const char* why = nullptr;
  glfwGetError(&why);
  throw std::runtime_error(
      fmt::format("{}: {}; gigabake serve shows the scene in a browser", what, why ? why : "unknown reason"));
}

struct Glfw {
  Glfw() {
    if (glfwInit() != GLFW_TRUE) fail_at("no display");
  }
  ~Glfw() { glfwTerminate(); }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

GLFWwindow* open_window(const WindowOptions& options, const std::string& title) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 2);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 1);
  GLFWwindow* window = glfwCreateWindow(options.width, options.height, title.c_str(), nullptr, nullptr);
  if (!window) fail_at("no window with OpenGL 2.1");
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  return window;
}

struct Gui {
  explicit Gui(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL2_Init();
  }
  ~Gui() {
    ImGui_ImplOpenGL2_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
};

/// Returns the pixel error that is `coarser` half levels coarser, rounded to a power of √2. Equal numbers of steps in
/// both directions therefore restore the same value.
double half_levels(double pixel_error, int coarser) {
  return std::exp2((std::round(2 * std::log2(pixel_error)) + coarser) / 2);
}

/// Returns the first unused name, starting with gigabake-0001.png.
std::filesystem::path free_name(const std::filesystem::path& folder, const char* kind) {
  for (int i = 1; i <= max_files; ++i) {
    std::filesystem::path path = folder / fmt::format("gigabake-{:04}.{}", i, kind);
    if (!std::filesystem::exists(path)) return path;
  }
  throw std::runtime_error(
      fmt::format("{}: {} files gigabake-*.{} exist already", short_path(folder.string()), max_files, kind));
}

class Window {
 public:
  Window(const std::filesystem::path& scene, LiveScene::Options scene_options, const WindowOptions& options)
      : options_(options),
        name_("gigabake " + scene.string()),
        window_(open_window(options, name_)),
        input_(window_),
        gui_(window_),
        scene_(scene, std::move(scene_options)),
        viewer_(scene_.add_viewer().value()),
        edits_(scene_, viewer_),
        views_(options.output) {}

  void run() {
    int redraws = redraws_after_event;
    while (glfwWindowShouldClose(window_) == 0) {
      glfwWaitEventsTimeout(redraws > 0 || input_.holds() ? held_poll_s : idle_poll_s);
      handle();
      const bool news = take_frame();
      finish_picture();
      if (const auto told = edits_.finished()) say(*told);
      set_title();
      if (recorder_) recorder_->see(state().pose, glfwGetTime());
      redraws = input_.take_touched() || news ? redraws_after_event : std::max(redraws - 1, 0);
      if (redraws > 0) draw();
    }
    options_.told(std::string("closed: ") + closed_by_);
  }

 private:
  ViewerState state() const { return scene_.state(viewer_).value(); }

  void handle() {
    ViewerInput input = input_.take_input();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (width > 0 && height > 0 && std::array{width, height} != size_) input.size = size_ = {width, height};
    for (const WindowCommand command : input_.take_commands()) handle(command, input);
    for (const ViewKey key : input_.take_view_keys()) handle(key, input);
    const bool settings = input.mode || input.style || input.pixel_error || input.size;
    if (input.moves() || settings || input.walk || input.swing) scene_.steer(viewer_, input);
  }

  void handle(WindowCommand command, ViewerInput& input) {
    const ViewerState now = state();
    constexpr std::size_t modes = names_of<ViewMode>().size();
    const bool orbits = now.style == CameraController::Style::orbit;
    switch (command) {
      case WindowCommand::next_mode:
        input.mode = ViewMode((std::size_t(now.full_view.mode) + 1) % modes);
        break;
      case WindowCommand::next_style:
        input.style = orbits ? CameraController::Style::fly : CameraController::Style::orbit;
        break;
      case WindowCommand::coarser:
        input.pixel_error = half_levels(now.full_view.camera.pixel_error, 1);
        break;
      case WindowCommand::finer:
        input.pixel_error = half_levels(now.full_view.camera.pixel_error, -1);
        break;
      case WindowCommand::measure:
        measure();
        break;
      case WindowCommand::save_picture:
        request_image();
        break;
      case WindowCommand::record:
        toggle_recording();
        break;
      case WindowCommand::toggle_panel:
        shows_panel_ = !shows_panel_;
        break;
      case WindowCommand::toggle_keys:
        shows_keys_ = !shows_keys_;
        break;
      case WindowCommand::toggle_brush:
        shows_brush_ = scene_.may_edit() && !shows_brush_;
        break;
      case WindowCommand::apply_edit:
        if (shows_brush_) edits_.apply();
        break;
      case WindowCommand::click:
        click();
        break;
      case WindowCommand::close:
        closed_by_ = "Esc";
        glfwSetWindowShouldClose(window_, GLFW_TRUE);
        break;
    }
  }

  void handle(ViewKey key, ViewerInput& input) {
    if (!frame_) return;
    try {
      if (key.keeps) {
        views_.keep(key.digit, state().pose);
        return say("saved " + std::filesystem::absolute(views_.file_of(key.digit)).lexically_normal().string());
      }
      input.pose = views_.kept(key.digit, frame_->rays.origin);
      if (!input.pose) return note(fmt::format("no view is saved as {0}: Shift {0} saves this one", key.digit));
      input.turn = input.pan = {};  // movements from before the jump would change the bookmarked pose
      input.zoom = 0;
    } catch (const std::exception& e) {
      say(e.what());
    }
  }

  /// Returns the scene point under the mouse, in the current image.
  std::optional<PickedPoint> pointed() const {
    const auto mouse = input_.mouse();
    if (!mouse || !frame_) return {};
    return picked_point(frame_->frame.picture, frame_->rays, (*mouse)[0], (*mouse)[1]);
  }

  void measure() {
    const std::optional<PickedPoint> to = pointed();
    if (!to) return note("point at a surface to measure from it");
    const std::optional<PickedPoint> from = std::exchange(measured_from_, {});
    if (from) return say(distance_text(*from, *to));
    measured_from_ = to;
    note("from " + place_text(*to) + ": press C at the other end");
  }

  /// Places the brush at a surface if its panel is shown. Otherwise prints the facts of the cell under the mouse while
  /// a bake is watched.
  void click() {
    const auto mouse = input_.mouse();
    if (!mouse) return;
    if (const std::optional<PickedPoint> at = pointed(); at && shows_brush_) note(edits_.place(*at));
    if (const auto facts = scene_.facts_at(viewer_, (*mouse)[0], (*mouse)[1])) say(cell_text(*facts));
  }

  bool take_frame() {
    const auto newer = scene_.frame_after(viewer_, frame_ ? frame_->number : 0, 0);
    if (!newer) return false;
    frame_ = newer;
    picture_.set(frame_->frame.picture);
    return true;
  }

  /// Shows a message in the window, but not on the console.
  void note(const std::string& text) {
    message_ = text;
    message_at_s_ = glfwGetTime();
    input_.touch();
  }

  void say(const std::string& text) {
    note(text);
    options_.told(text);
  }

  /// Shows the last message, for a limited time, and the loading state in the title, because the panel may be hidden.
  void set_title() {
    const std::string loading = loading_text(state(), frame_.get());
    std::string title = name_;
    if (!loading.empty()) title += " - " + loading;
    if (!message_.empty() && glfwGetTime() < message_at_s_ + message_s) title += " - " + message_;
    if (title == title_) return;
    title_ = title;
    glfwSetWindowTitle(window_, title.c_str());
  }

  void request_image() {
    image_is_requested_ = true;
    if (!state().resting) note("the image will be saved once it is complete");
  }

  void finish_picture() {
    if (!image_is_requested_) return;
    const auto full = scene_.full_frame(viewer_, 0);
    if (!full) return;
    image_is_requested_ = false;
    const Picture& picture = full->clean_picture();
    save("png", fmt::format(", {}x{}", picture.width, picture.height),
         [&](const auto& path) { write_png(path, picture); });
  }

  void toggle_recording() {
    if (!recorder_) {
      recorder_.emplace();
      return say("recording");
    }
    const auto path = std::exchange(recorder_, std::nullopt)->path();
    if (path) save("json", "", [&](const auto& file) { publish_file(file, to_json(*path)); });
  }

  template <class Write>
  void save(const char* kind, const std::string& what, const Write& write) {
    try {
      const std::filesystem::path path = free_name(options_.output, kind);
      write(path);
      say("saved " + std::filesystem::absolute(path).lexically_normal().string() + what);
    } catch (const std::exception& e) {
      say(e.what());
    }
  }

  void draw() {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    picture_.draw(width, height);
    ImGui_ImplOpenGL2_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    PanelAnswer answer;
    const std::optional<PickedPoint> place = pointed();
    if (shows_panel_)
      answer =
          show_panel(state(), frame_.get(), recorder_.has_value(), message_, place ? place_text(*place) : "", clock_);
    if (shows_keys_) show_keys();
    if (const std::string told = shows_brush_ ? edits_.show() : std::string(); !told.empty()) note(told);
    ImGui::Render();
    ImGui_ImplOpenGL2_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_);
    const ViewerInput& s = answer.input;
    const bool lights = s.sun || s.time || s.shadows || s.level_blend;
    if (s.home || s.mode || s.style || s.pixel_error || s.upload_s || lights) scene_.steer(viewer_, s);
    if (answer.save_picture) request_image();
    if (answer.record) toggle_recording();
  }

  const WindowOptions options_;
  const std::string name_;
  GLFWwindow* window_;
  WindowInput input_;
  Gui gui_;
  ScreenImage picture_;
  LiveScene scene_;
  const LiveScene::ViewerId viewer_;
  LiveScene::FramePtr frame_;
  std::array<int, 2> size_{};
  WindowEdits edits_;
  std::optional<PathRecorder> recorder_;
  const Bookmarks views_;
  std::optional<PickedPoint> measured_from_;
  const char* closed_by_ = "the window was closed";
  std::string message_, title_;
  double message_at_s_ = 0;
  bool image_is_requested_ = false, shows_panel_ = true, shows_keys_ = false, shows_brush_ = false;
  SunClock clock_;
};

}  // namespace

void show_window(const std::filesystem::path& scene, LiveScene::Options scene_options, const WindowOptions& options) {
  const Glfw glfw;
  scene_options.changed = [] { glfwPostEmptyEvent(); };
  Window(scene, std::move(scene_options), options).run();
}

}  // namespace gigabake
