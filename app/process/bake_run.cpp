#include "app/process/bake_run.h"

#include <fmt/format.h>
#include <functional>
#include <unistd.h>
#include <utility>

#include "app/commands.h"
#include "app/messages/bake_console.h"
#include "app/messages/bake_report.h"
#include "app/options/flags.h"
#include "app/process/stop_signal.h"
#include "cluster/launch/launcher.h"
#include "cluster/process/bake_process.h"
#include "cluster/process/drain.h"
#include "core/base/error.h"
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

int run(const BakeRequest& request, const BakeOutput& output, MpiSession& mpi, std::unique_ptr<ChildProcess> early) {
  BakeConsole console(mpi.rank() == 0 && !output.quiet ? stderr : nullptr, {is_drain_requested, {}});
  BakeProgress progress = console.progress();
  const bool has_time = output.log_time.value_or(::isatty(STDERR_FILENO) == 0);
  std::optional<MessageTime> log_time;
  const auto begin_log = [&] {
    if (has_time) log_time.emplace(mpi.rank());
  };
  if (mpi.rank() != 0) begin_log();
  set_interrupt_message(
      "\ngigabake: stopped immediately, before the first cell; the same command starts the bake again\n");
  if (output.quiet) progress.listener = print_warnings;
  progress.listener = with_log_time(progress.listener, begin_log);
  const BakeSummary summary = bake(mpi, request, progress, std::move(early));
  log_time.reset();  // lines after this one are the result of the command
  if (mpi.rank() != 0) return complete;
  const std::string report = json_report(summary, request.out);
  if (output.json)
    fmt::print("{}", report);
  else if (!output.quiet)
    print_report(summary, request.out);
  warn_of(summary.precision);
  print_losses(summary.scene.losses);
  if (!output.report.empty()) publish_file(output.report, report, Durability::across_power_loss, Leftovers::remove);
  const int exit_code = exit_code_of(summary);
  if (summary.lost_ranks != 0) mpi.abort(exit_code);  // a rank that hangs would never reach MPI's finalization
  return exit_code;
}

}  // namespace

std::unique_ptr<ChildProcess> start_bake_process(Backend backend, const std::vector<int>& gpus) {
  const auto local = local_rank_from_launcher(environment_of_process);
  return local ? start_early({backend, gpus, local->rank, local->ranks}) : nullptr;
}

int run_bake(const BakeRequest& request, const BakeOutput& output, MpiSession& mpi,
             std::unique_ptr<ChildProcess> early) {
  try {
    return run(request, output, mpi, std::move(early));
  } catch (const Stopped&) {
    if (mpi.rank() == 0)
      print_message("gigabake: stopped by a signal before the first cell; run the same command again to resume\n");
    return drained;
  }
}

}  // namespace gigabake::app
