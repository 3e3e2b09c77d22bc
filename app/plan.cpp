#include <memory>

#include "app/bake_options.h"
#include "app/bake_report.h"
#include "app/commands.h"
#include "app/on_all_ranks.h"
#include "app/progress.h"

namespace gigabake::app {
namespace {

int run(const BakeOptions& options, MpiSession& mpi) {
  Progress progress;
  const BakePlan plan = plan_bake(mpi, options.request(), progress.callbacks());
  if (mpi.rank() != 0) return complete;
  options.json ? print_json_report(plan) : print_report(plan);
  print_losses(plan.losses);
  return plan.losses.empty() ? complete : cells_failed;
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("plan", "What a bake would do: cells, triangles, memory, time; bakes nothing");
  auto options = std::make_shared<BakeOptions>();
  options->add_to(*command);
  command->callback(
      [options, &exit_code] { exit_code = on_all_ranks([&](MpiSession& mpi) { return run(*options, mpi); }); });
}

}  // namespace gigabake::app
