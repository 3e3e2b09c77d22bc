#include <fmt/format.h>
#include <memory>

#include "app/commands.h"
#include "app/edit/bake_record.h"
#include "app/options/bake_options.h"
#include "app/options/output_file.h"
#include "app/options/scene_argument.h"
#include "app/process/bake_run.h"
#include "app/process/on_all_ranks.h"
#include "app/process/rank_start.h"
#include "cluster/process/drain.h"

namespace gigabake::app {
namespace {

/// Checks the output paths before the bake starts.
void check_outputs(const BakeOptions& options) {
  expect_bake_output(options.out);
  std::vector<std::filesystem::path> kept = files_of_bake(options.out);
  kept.emplace_back(options.source);
  expect_own_file("--report", options.report, "{\n  \"scene\"", kept);
  expect_parent_folder("--report", options.report, options.out);
  kept.emplace_back(options.report);
  expect_own_file("--metrics", options.metrics, "# HELP gigabake_", kept);
}

int run(const BakeOptions& options, MpiSession& mpi, std::unique_ptr<ChildProcess> early) {
  BakeRequest request = options.request_of(mpi);
  request.source_record = bake_record(options);
  collective_try(mpi, [&] {
    if (mpi.rank() == 0) check_outputs(options);
  });
  return run_bake(request, {options.json, options.quiet, options.log_time, options.report}, mpi, std::move(early));
}

}  // namespace

void add_bake(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("bake", "Bake a scene into paged sparse voxel oct-trees; under mpirun on all ranks");
  auto options = std::make_shared<BakeOptions>();
  options->add_to(*command);
  command->add_option("-o,--out", options->out, "folder of the baked scene: scene.xml and shards/")->required();
  command->add_option("--metrics", options->metrics,
                      "file to write for Prometheus' node_exporter (*.prom), updated every second");
  command->add_option("--report", options->report,
                      "JSON file to write, with the contents that --json prints: counts, times, accuracy");
  command->add_flag("--keep-going,!--no-keep-going", options->asked.keep_going,
                    "after a tile or cell failed, bake the rest (default), or stop and publish nothing");
  command->add_flag("--overviews,!--no-overviews", options->asked.overviews,
                    "write overview shards, which contain the levels above the cells (default); without them, a view "
                    "of the whole scene loads every cell, and no level is coarser than the coarsest of a cell");
  command->add_flag("--prune", options->asked.prune,
                    "once the scene is complete, remove shards that it does not use (default: keep them; a bake with "
                    "earlier settings reuses them)");
  command->add_option("--ranks", options->ranks,
                      "ranks to start on this host with mpirun (one per GPU; 1 without GPUs, in a batch job, or if "
                      "mpirun starts gigabake)");
  command->add_flag("-q,--quiet", options->quiet, "print only errors, warnings and missing inputs");
  command->add_flag_function(
      "--log-time,!--no-log-time", [options](std::int64_t given) { options->log_time = given > 0; },
      "print time and rank before each line of the log (default if standard error is not a terminal)");
  Timeouts& timeouts = options->asked.timeouts;
  const auto add_seconds = [command](const char* name, double& seconds, const char* description) {
    command->add_option(name, seconds, fmt::format("{} ({:g})", description, seconds));
  };
  add_seconds("--stall", timeouts.no_progress_s,
              "seconds without progress after which a bake process counts as hung and is killed");
  add_seconds("--cell-timeout", timeouts.cell_timeout_s, "max seconds for one cell");
  add_seconds("--silence", timeouts.heartbeat_timeout_s,
              "heartbeat timeout: seconds without a message after which a rank counts as lost");
  command->callback([options, &exit_code] {
    if (const std::optional<int> ranks = ranks_to_start(*options)) {
      exit_code = run_on_ranks(*options, *ranks);
      return;
    }
    install_drain_handlers();  // before MPI starts, because mpirun passes signals on from the beginning
    auto early = start_bake_process(options->asked.backend, options->asked.gpus);
    exit_code = on_all_ranks("bake", [&](MpiSession& mpi) { return run(*options, mpi, std::move(early)); });
  });
}

}  // namespace gigabake::app
