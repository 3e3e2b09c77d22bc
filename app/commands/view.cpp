#include <cstdio>
#include <fmt/core.h>
#include <memory>
#include <tuple>

#include "app/commands.h"
#include "app/options/live_options.h"
#include "app/options/scene_argument.h"
#include "app/options/text_values.h"
#include "app/process/missing_report.h"
#include "format/scene/paged_scene.h"
#include "viewer/window/window.h"

namespace gigabake::app {
namespace {

struct ViewArguments {
  LiveArguments live;
  std::string size = "1280x720", output = ".";
};

void run(ViewArguments& a) {
  a.live.scene = scene_argument(a.live.scene).string();
  LiveScene::Options scene_options = live_options(a.live);
  WindowOptions window;
  std::tie(window.width, window.height) = size_option(a.size);
  window.output = a.output;
  window.told = [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  };
  const PagedScene scene(a.live.scene);  // opened before the window, so that errors are printed on the terminal
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
  command.callback([a] { run(*a); });
}

}  // namespace gigabake::app
