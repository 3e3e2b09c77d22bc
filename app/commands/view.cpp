#include <cstdio>
#include <filesystem>
#include <fmt/core.h>
#include <memory>
#include <tuple>

#include "app/commands.h"
#include "app/edit/scene_editor.h"
#include "app/options/live_options.h"
#include "app/options/scene_argument.h"
#include "app/options/text_values.h"
#include "app/process/missing_report.h"
#include "cluster/bake/output_folder.h"
#include "cluster/watch/bake_watch.h"
#include "format/scene/paged_scene.h"
#include "viewer/window/window.h"

namespace gigabake::app {
namespace {

struct ViewArguments {
  LiveArguments live;
  std::string size = "1280x720", output = ".";
  bool edit = false;
};

/// Returns the scene.xml to show; it need not exist if a bake has planned its cells.
std::filesystem::path scene_to_view(const std::string& given) {
  std::error_code error;
  const bool is_begun = std::filesystem::exists(plan_file_of(given), error) &&
                        !std::filesystem::exists(std::filesystem::path(given) / "scene.xml", error);
  return is_begun ? live_scene_argument(given) : scene_argument(given);
}

void run(ViewArguments& a) {
  const std::filesystem::path path = scene_to_view(a.live.scene);
  a.live.scene = path.string();
  LiveScene::Options scene_options = live_options(a.live);
  WindowOptions window;
  std::tie(window.width, window.height) = size_option(a.size);
  window.output = a.output;
  window.told = [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  };
  // The scene is opened before the window, so that errors are printed on the terminal.
  if (std::filesystem::exists(path) || !std::filesystem::exists(plan_file_of(path.parent_path()))) PagedScene{path};
  scene_options.watch = std::make_shared<BakeWatch>(path.has_parent_path() ? path.parent_path() : ".");
  if (a.edit) scene_options.editor = make_scene_editor(path.has_parent_path() ? path.parent_path() : ".");
  report_missing_data(complete);
  show_window(a.live.scene, std::move(scene_options), window);
}

}  // namespace

void add_view(CLI::App& app, int&) {
  const auto a = std::make_shared<ViewArguments>();
  CLI::App& command =
      *app.add_subcommand("view", "Show a baked scene in a window, to fly through (keys: docs/viewer.md)");
  add_live_options(command, a->live);
  command.add_option("--size", a->size, "WIDTHxHEIGHT of the window")->capture_default_str();
  command.add_option("-o,--output", a->output, "folder for saved images and paths")->capture_default_str();
  command.add_flag("--edit", a->edit, "offer a brush that changes the scene: F2 (docs/editing.md)");
  command.callback([a] { run(*a); });
}

}  // namespace gigabake::app
