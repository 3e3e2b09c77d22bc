#include <fmt/format.h>
#include <memory>
#include <optional>

#include "app/commands.h"
#include "app/messages/bake_console.h"
#include "app/messages/bake_report.h"
#include "app/options/bake_options.h"
#include "app/options/flags.h"
#include "app/process/on_all_ranks.h"
#include "app/process/stop_signal.h"
#include "cluster/bake/empty_scene.h"
#include "format/system/message.h"
#include "scheduler/journal/cached_results.h"

namespace gigabake::app {
namespace {

std::optional<CachedResults> prior_of(const BakePlan& plan, const BakeRequest& request, const MpiSession& mpi) {
  if (request.out.empty()) return std::nullopt;
  return find_cached(plan, read_journal(request.out / "journal"), request.out, mpi.cores());
}

/// Prints an error if a bake would have no visible voxel. Returns true if sample cells of the whole surface were baked
/// and none has a voxel. If the samples cover only a part of the surface, prints a warning and returns false.
bool is_refused_as_empty(const BakeRequest& request, const PlannedBake& planned, const PlanMeasure& measure) {
  constexpr double rounding = 1e-3;
  const MeasuredSize& size = measure.requested();
  if (size.pieces == 0 || size.voxels_found != 0 || !planned.plan.losses.empty()) return false;
  const bool is_whole = size.estimate.share > 1 - rounding;
  const InputError failure = nothing_visible(request.source, planned.sources.scene, planned.plan,
                                             is_whole ? "a bake would fail" : "a bake may fail");
  print_message("gigabake: {}{}\n", is_whole ? "" : "warning: ", with_flags(failure.what()));
  return is_whole;
}

struct PlanOptions {
  BakeOptions bake;
  bool measures = true, lists_cells = false;
};

int run(const PlanOptions& plan_options, MpiSession& mpi) {
  const BakeOptions& options = plan_options.bake;
  const BakeRequest request = options.request_of(mpi);
  BakeConsole console(mpi.rank() == 0 ? stderr : nullptr, {[] { return stop_signal() != 0; }, {}});
  const BakeProgress progress = console.progress();
  const PlannedBake planned = plan_bake(mpi, request, progress);
  if (mpi.rank() != 0) return complete;
  const BakePlan& plan = planned.plan;
  const PlanSizes sizes{measure_plan(mpi, request, planned.sources, plan, plan_options.measures, progress.steps),
                        planned.scan_s};
  const std::optional<CachedResults> prior = prior_of(plan, request, mpi);
  console.end_step();
  if (is_refused_as_empty(request, planned, sizes.measure)) return failed;
  options.json ? print_json_report(plan, prior, sizes) : print_report(plan, prior, sizes, plan_options.lists_cells);
  warn_of(plan.precision);
  print_losses(plan.losses);
  return plan.losses.empty() ? complete : cells_failed;
}

/// Runs the plan. Only rank 0 measures; the other ranks receive its exit code.
int run_until_stopped(const PlanOptions& options, MpiSession& mpi) {
  try {
    return run(options, mpi);
  } catch (const Stopped&) {
    if (mpi.rank() == 0) print_message("{}\n", stop_line());
    return exit_code_of_stop();
  }
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "plan",
      "Predict voxels, bytes on disk and minutes of a bake, for this voxel size, half and twice it; list its cells");
  auto options = std::make_shared<PlanOptions>();
  options->bake.add_to(*command);
  command->add_option("-o,--out", options->bake.out,
                      "folder of an earlier bake: also print how many cells a bake into it would bake, why, and how "
                      "long that takes; nothing is written");
  command->add_flag("--cells", options->lists_cells, "list every cell, with -o also whether it would be baked and why");
  command->add_flag("--measure,!--no-measure", options->measures,
                    "bake pieces of the scene for about four seconds into a temporary folder (default); without this, "
                    "no time is predicted, and voxels and bytes only from the area of the surface");
  command->callback([options, &exit_code] {
    const StopSignals signals;  // before MPI starts, because mpirun passes signals on from the beginning
    exit_code = on_all_ranks("plan", [&](MpiSession& mpi) { return run_until_stopped(*options, mpi); });
  });
}

}  // namespace gigabake::app
