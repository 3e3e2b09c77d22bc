#include <memory>

#include "app/bake_options.h"
#include "app/bake_report.h"
#include "app/commands.h"
#include "app/on_all_ranks.h"
#include "app/progress.h"

namespace gigabake::app {
namespace {

int run(const BakeOptions& options, MpiSession& mpi) {
  const BakeRequest request = options.request();
  Progress progress;
  const BakeSummary summary = bake(mpi, request, progress.callbacks());
  if (mpi.rank() != 0) return complete;
  options.json ? print_json_report(summary, request.out) : print_report(summary, request.out);
  print_losses(summary.scene.losses);
  return summary.scene.losses.empty() ? complete : cells_failed;
}

}  // namespace

void add_bake(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("bake", "Bake a scene into paged sparse voxel oct-trees; under mpirun on all ranks");
  auto options = std::make_shared<BakeOptions>();
  options->add_to(*command);
  command->add_option("-o,--out", options->out, "folder of the result: scene.xml and shards/")->required();
  command->add_flag("--keep-going,!--no-keep-going", options->keep_going,
                    "bake the rest after a tile or cell failed (default), or stop there and publish nothing");
  command->add_flag(
      "--prune", options->prune,
      "remove shards that the new scene does not have; without, they stay for a return to earlier settings");
  command->callback(
      [options, &exit_code] { exit_code = on_all_ranks([&](MpiSession& mpi) { return run(*options, mpi); }); });
}

}  // namespace gigabake::app
