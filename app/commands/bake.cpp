#include <fmt/format.h>
#include <memory>

#include "app/commands.h"
#include "app/messages/bake_console.h"
#include "app/messages/bake_report.h"
#include "app/options/bake_options.h"
#include "app/options/flags.h"
#include "app/process/on_all_ranks.h"
#include "cluster/drain.h"
#include "format/system/publish.h"

namespace gigabake::app {
namespace {

int exit_code_of(const BakeSummary& summary) {
  if (summary.is_drained) return drained;
  return summary.scene.losses.empty() ? complete : cells_failed;
}

/// What --quiet leaves of a bake's progress.
BakeProgress warnings_alone(const Progress& steps) {
  BakeProgress p;
  p.steps = steps;
  p.opened = [](const SceneSources&) {};
  p.surveyed = [](std::size_t, std::size_t) {};
  p.planned = [](const BakePlan&) {};
  p.status = [](const BakeStatus&) {};
  p.cell_done = [](const CellReport& report, const CellJob& job) {
    if (!report.note.empty()) fmt::print(stderr, "cell {}: {}\n", job.name, with_flags(report.note));
  };
  p.told = [](const std::string&) {};
  p.noted = [](const std::string& line) { fmt::print(stderr, "{}\n", with_flags(line)); };
  return p;
}

int run(const BakeOptions& options, MpiSession& mpi) {
  const BakeRequest request = options.request();
  BakeConsole console(mpi.rank() == 0 && !options.quiet ? stderr : nullptr, {is_drain_asked, {}});
  BakeProgress progress = console.callbacks();
  const BakeSummary summary = bake(mpi, request, options.quiet ? warnings_alone(progress.steps) : progress);
  if (mpi.rank() != 0) return complete;
  const std::string report = json_report(summary, request.out);
  if (options.json)
    fmt::print("{}", report);
  else if (!options.quiet)
    print_report(summary, request.out);
  warn_of(summary.precision);
  print_losses(summary.scene.losses);
  if (!options.report.empty()) publish_file(options.report, report);
  const int exit_code = exit_code_of(summary);
  if (summary.lost_ranks != 0) mpi.abort(exit_code);  // a rank that hangs would never join the end
  return exit_code;
}

/// Of every rank.
int run_until_stopped(const BakeOptions& options, MpiSession& mpi) {
  try {
    return run(options, mpi);
  } catch (const Stopped&) {
    if (mpi.rank() == 0)
      fmt::print(stderr, "gigabake: asked to end before the first cell; run the same command again to go on\n");
    return drained;
  }
}

}  // namespace

void add_bake(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("bake", "Bake a scene into paged sparse voxel oct-trees; under mpirun on all ranks");
  auto options = std::make_shared<BakeOptions>();
  options->add_to(*command);
  command->add_option("-o,--out", options->out, "folder of the result: scene.xml and shards/")->required();
  command->add_option("--metrics", options->metrics,
                      "file that Prometheus' node_exporter reads (*.prom), rewritten every second");
  command->add_option("--report", options->report, "file for what --json prints: counts, times, accuracy figures");
  command->add_flag("--keep-going,!--no-keep-going", options->asked.keep_going,
                    "bake the rest after a tile or cell failed (default), or stop there and publish nothing");
  command->add_flag("--prune", options->asked.prune,
                    "once the scene is whole, remove shards that it does not have; without, they stay for a return to "
                    "earlier settings");
  command->add_flag("-q,--quiet", options->quiet, "print errors, warnings and what is missing alone");
  Patience& patience = options->asked.patience;
  const auto add_seconds = [command](const char* name, double& seconds, const char* description) {
    command->add_option(name, seconds, fmt::format("{} ({:g})", description, seconds));
  };
  add_seconds("--stall", patience.stall_s, "seconds without any work after which a bake process hangs");
  add_seconds("--cell-timeout", patience.cell_timeout_s, "most seconds for one cell");
  add_seconds("--silence", patience.silence_s, "seconds after which a rank that is not heard of is lost");
  command->callback([options, &exit_code] {
    watch_for_drain();  // before MPI starts: mpirun passes signals on from the beginning
    exit_code = on_all_ranks([&](MpiSession& mpi) { return run_until_stopped(*options, mpi); });
  });
}

}  // namespace gigabake::app
