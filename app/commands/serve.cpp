#include <chrono>
#include <filesystem>
#include <fmt/core.h>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "app/commands/bake_state.h"
#include "app/edit/scene_editor.h"
#include "app/options/live_options.h"
#include "app/options/scene_argument.h"
#include "app/process/missing_report.h"
#include "app/process/standard_streams.h"
#include "app/process/stop_signal.h"
#include "cluster/watch/bake_watch.h"
#include "core/base/error.h"
#include "core/base/progress.h"
#include "viewer/web/http_guard.h"
#include "viewer/web/stream_server.h"

namespace gigabake::app {
namespace {

constexpr std::chrono::milliseconds stop_check{50};

struct ServeArguments {
  LiveArguments live;
  StreamServer::Options server;
  std::size_t max_viewers = LiveScene::Options{}.max_viewers;
  bool edit = false;
};

void run(ServeArguments& a) {
  const std::filesystem::path scene = live_scene_argument(a.live.scene);
  const std::filesystem::path out = scene.has_parent_path() ? scene.parent_path() : ".";
  LiveScene::Options scene_options = live_options(a.live);
  if (a.max_viewers < 1 || a.max_viewers > 64) throw UsageError("--viewers: expected 1 to 64");
  scene_options.max_viewers = a.max_viewers;
  // A page that may change files needs a secret even on this machine, where other users and pages can connect.
  if (a.server.token.empty() && (a.edit || StreamServer::is_public(a.server))) a.server.token = random_key();
  if (a.edit) scene_options.editor = make_scene_editor(out);
  a.server.bake_status = [out] { return bake_status_json(out.string()); };
  scene_options.watch = std::make_shared<BakeWatch>(out);
  LiveScene live(scene, std::move(scene_options));
  StreamServer server(live, a.server);
  const StopSignals signals(a.edit ? "gigabake: stopped immediately; an edit that was begun ends by itself\n"
                                   : "gigabake: stopped immediately; serving changes no file\n");
  fmt::print("{}\n", server.url());
  if (!a.server.external_url.empty()) fmt::print("the proxy connects to {} port {}\n", a.server.bind, server.port());
  if (!std::filesystem::exists(scene))
    fmt::print("waiting for a bake into {}: there is no {} yet\n", out.string(),
               std::filesystem::is_directory(out) ? "scene.xml" : "such folder");
  flush_output();
  report_missing_data(complete);
  // A separate thread stops the server, because a signal handler must not.
  const std::jthread stopper([&server](const std::stop_token& over) {
    while (!over.stop_requested() && stop_signal() == 0) std::this_thread::sleep_for(stop_check);
    server.stop();
  });
  server.serve();
  if (stop_signal() != 0) throw Stopped();
}

}  // namespace

void add_serve(CLI::App& app, int&) {
  const auto a = std::make_shared<ServeArguments>();
  CLI::App& command = *app.add_subcommand(
      "serve", "Show a baked scene, or one that is being baked, in a browser; prints the address to open");
  add_live_options(command, a->live);
  command
      .add_option("--bind", a->server.bind, "address to listen on; if other machines can reach it, a token is required")
      ->capture_default_str();
  command.add_option("--port", a->server.port, "port; 0: any free port")->capture_default_str();
  command.add_option("--token", a->server.token,
                     "secret that browsers must send (if other machines can connect: generated and printed)");
  command.add_option("--external-url", a->server.external_url,
                     "address under which a proxy on this machine shows the page: https://HOST/PATH/ (docs/viewer.md)");
  command.add_flag("--edit", a->edit,
                   "let viewers change the scene (docs/editing.md); requires a token, which is generated and printed");
  command.add_option("--viewers", a->max_viewers, "max number of concurrent viewers")->capture_default_str();
  command.callback([a] { run(*a); });
}

}  // namespace gigabake::app
