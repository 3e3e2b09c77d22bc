#include <memory>
#include <optional>

#include "app/bake_options.h"
#include "app/bake_report.h"
#include "app/commands.h"
#include "app/on_all_ranks.h"
#include "app/progress.h"
#include "scheduler/prior.h"

namespace gigabake::app {
namespace {

std::optional<PriorResults> prior_of(const BakePlan& plan, const BakeRequest& request, const MpiSession& mpi) {
  if (request.out.empty()) return std::nullopt;
  return find_prior(plan, read_journal(request.out / "journal"), request.out, mpi.cores());
}

int run(const BakeOptions& options, MpiSession& mpi) {
  const BakeRequest request = options.request();
  Progress progress;
  const BakePlan plan = plan_bake(mpi, request, progress.callbacks());
  if (mpi.rank() != 0) return complete;
  const std::optional<PriorResults> prior = prior_of(plan, request, mpi);
  options.json ? print_json_report(plan, prior) : print_report(plan, prior);
  warn_of(plan.precision);
  print_losses(plan.losses);
  return plan.losses.empty() ? complete : cells_failed;
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("plan", "What a bake would do: cells, triangles, memory, time; bakes nothing");
  auto options = std::make_shared<BakeOptions>();
  options->add_to(*command);
  command->add_option("-o,--out", options->out,
                      "folder of an earlier bake: say of each cell whether it would be baked, "
                      "and why; nothing is written");
  command->callback(
      [options, &exit_code] { exit_code = on_all_ranks([&](MpiSession& mpi) { return run(*options, mpi); }); });
}

}  // namespace gigabake::app
