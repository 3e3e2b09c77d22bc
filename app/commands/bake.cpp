#include <fmt/format.h>
#include <functional>
#include <memory>
#include <optional>
#include <unistd.h>

#include "app/commands.h"
#include "app/messages/bake_console.h"
#include "app/messages/bake_report.h"
#include "app/options/bake_options.h"
#include "app/options/flags.h"
#include "app/options/output_file.h"
#include "app/options/scene_argument.h"
#include "app/process/on_all_ranks.h"
#include "cluster/process/drain.h"
#include "format/system/message.h"
#include "format/system/publish.h"

namespace gigabake::app {
namespace {

int exit_code_of(const BakeSummary& summary) {
  if (summary.is_drained) return drained;
  return summary.scene.losses.empty() ? complete : cells_failed;
}

/// Prints the warnings of an event. Under --quiet, nothing else of the event is printed.
void print_warnings(const BakeEvent& event) {
  if (const auto* source = std::get_if<SourceOpened>(&event)) {
    for (const std::string& note : source->sources.notes)
      if (note.starts_with("warning: ")) print_message("{}\n", with_flags(note));
  }
  if (const auto* jobs = std::get_if<JobsPlanned>(&event)) {
    for (const std::string& warning : jobs->plan.warnings) print_message("warning: {}\n", with_flags(warning));
  }
  if (const auto warning = warning_of(event)) print_message("{}\n", with_flags(*warning));
}

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

/// Returns the line that a second Ctrl-C prints.
std::string state_left(const BakeStatus& s) {
  const CellTally& c = s.cells;
  const std::string done = s.state == BakeState::scanning
                               ? fmt::format("{} of {} tiles scanned", s.tiles_scanned, s.tiles)
                               : fmt::format("{} of {} cells are in SCENE", c.taken_over + c.done + c.empty, c.planned);
  return fmt::format("\ngigabake: stopped immediately, {}; the same command resumes the bake\n", done);
}

/// Returns a listener that calls `listener` and updates the text that a second Ctrl-C prints. It calls `begin_log` when
/// the source is opened, because later lines are a log with times. Earlier lines directly answer the command.
BakeListener with_log_time(const BakeListener& listener, const std::function<void()>& begin_log) {
  return [listener, begin_log](const BakeEvent& event) {
    if (std::holds_alternative<SourceOpened>(event)) begin_log();
    if (const auto* updated = std::get_if<StatusUpdated>(&event)) set_interrupt_message(state_left(updated->status));
    listener(event);
  };
}

int run(const BakeOptions& options, MpiSession& mpi) {
  const BakeRequest request = options.request_of(mpi);
  collective_try(mpi, [&] {
    if (mpi.rank() == 0) check_outputs(options);
  });
  BakeConsole console(mpi.rank() == 0 && !options.quiet ? stderr : nullptr, {is_drain_requested, {}});
  BakeProgress progress = console.progress();
  const bool has_time = options.log_time.value_or(::isatty(STDERR_FILENO) == 0);
  std::optional<MessageTime> log_time;
  const auto begin_log = [&] {
    if (has_time) log_time.emplace(mpi.rank());
  };
  if (mpi.rank() != 0) begin_log();
  set_interrupt_message(
      "\ngigabake: stopped immediately, before the first cell; the same command starts the bake again\n");
  if (options.quiet) progress.listener = print_warnings;
  progress.listener = with_log_time(progress.listener, begin_log);
  const BakeSummary summary = bake(mpi, request, progress);
  log_time.reset();  // lines after this one are the result of the command
  if (mpi.rank() != 0) return complete;
  const std::string report = json_report(summary, request.out);
  if (options.json)
    fmt::print("{}", report);
  else if (!options.quiet)
    print_report(summary, request.out);
  warn_of(summary.precision);
  print_losses(summary.scene.losses);
  if (!options.report.empty()) publish_file(options.report, report, Durability::across_power_loss, Leftovers::remove);
  const int exit_code = exit_code_of(summary);
  if (summary.lost_ranks != 0) mpi.abort(exit_code);  // a rank that hangs would never reach MPI's finalization
  return exit_code;
}

/// Runs the bake on every rank.
int run_until_stopped(const BakeOptions& options, MpiSession& mpi) {
  try {
    return run(options, mpi);
  } catch (const Stopped&) {
    if (mpi.rank() == 0)
      print_message("gigabake: stopped by a signal before the first cell; run the same command again to resume\n");
    return drained;
  }
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
    install_drain_handlers();  // before MPI starts, because mpirun passes signals on from the beginning
    exit_code = on_all_ranks("bake", [&](MpiSession& mpi) { return run_until_stopped(*options, mpi); });
  });
}

}  // namespace gigabake::app
