#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/progress_line.h"
#include "app/messages/status_text.h"
#include "app/options/scene_argument.h"
#include "app/process/standard_streams.h"
#include "cluster/watch/observed_status.h"

namespace gigabake::app {
namespace {

constexpr double look_every_s = 1;

struct StatusOptions {
  std::string out;
  bool json = false, follow = false;
};

/// Returns the exit code of the bake if it has ended; 0 while it runs.
int exit_code_of(const ObservedStatus& seen) {
  if (seen.interrupted || seen.status.state == BakeState::failed) return failed;
  if (seen.status.state == BakeState::incomplete) return cells_failed;
  return seen.status.state == BakeState::drained ? drained : complete;
}

void print_json(const ObservedStatus& seen) {
  auto j = nlohmann::ordered_json::parse(to_json(seen.status));
  j["interrupted"] = seen.interrupted;
  fmt::print("{}\n", json_text(j, -1));
}

void print_text(const ObservedStatus& seen) {
  fmt::print("{}", describe(seen.status, seen.now_s, seen.interrupted ? Writer::gone : Writer::there));
  if (seen.interrupted) fmt::print("no process bakes this scene any more; run the same command again to resume\n");
  if (seen.status.state == BakeState::drained) fmt::print("run the same command again to resume\n");
}

int follow(const StatusOptions& options) {
  ProgressLine line(stdout, 0);
  for (;; std::this_thread::sleep_for(std::chrono::duration<double>(look_every_s))) {
    const ObservedStatus seen = observe_status(options.out);
    const bool ended = is_over(seen.status.state) || seen.interrupted;
    if (options.json) {
      print_json(seen);
    } else if (!ended) {
      line.show(seen.status);
    } else {
      line.leave_bar();
      print_text(seen);
    }
    flush_output();
    if (ended) return exit_code_of(seen);
  }
}

int show(const StatusOptions& options) {
  const ObservedStatus seen = observe_status(options.out);
  options.json ? print_json(seen) : print_text(seen);
  return exit_code_of(seen);
}

}  // namespace

void add_status(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("status",
                                     "Print the progress of a bake, from any host that sees its folder; exit code: the "
                                     "bake's own after its end, 1 if it was interrupted, 0 while it runs");
  auto options = std::make_shared<StatusOptions>();
  command->add_option("SCENE", options->out, "folder of a bake, or its scene.xml")->required();
  command->add_flag("--json", options->json, "print the answer as JSON, one line each time");
  command->add_flag("--follow", options->follow, "print the status every second until the bake ends");
  command->callback([options, &exit_code] {
    options->out = bake_folder_argument(options->out).string();
    exit_code = options->follow ? follow(*options) : show(*options);
  });
}

}  // namespace gigabake::app
