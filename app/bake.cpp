#include <memory>

#include "app/bake_options.h"
#include "app/bake_report.h"
#include "app/commands.h"
#include "app/on_all_ranks.h"
#include "app/progress.h"
#include "cluster/status_feed.h"
#include "scheduler/estimate.h"

namespace gigabake::app {
namespace {

std::vector<double> costs_of(const BakePlan& plan) {
  std::vector<double> costs;
  for (const CellJob& job : plan.jobs) costs.push_back(double(cell_cost(job)));
  return costs;
}

void record_plan(const BakePlan& plan, BakeStatusRecord& record) {
  for (const SceneLoss& l : plan.losses) record.lost(l.name, l.reason);
  record.planned(plan.jobs, costs_of(plan), unix_now_s());
}

void record_cell(const CellReport& report, BakeStatusRecord& record) {
  const double now_s = unix_now_s();
  if (report.outcome != CellOutcome::failed) return record.cell_done(report, now_s);
  record.attempt_failed(report.id, now_s);
  record.set_aside(report.id, report.error, now_s);
}

/// The callbacks, and behind each of them the status.
BakeProgress with_status(const BakeProgress& callbacks, StatusFeed& feed) {
  BakeProgress p = callbacks;
  p.surveyed = [&feed, tell = callbacks.surveyed](std::size_t done, std::size_t all) {
    tell(done, all);
    feed.record().surveyed(done, all);
    feed.turn();
  };
  p.planned = [&feed, tell = callbacks.planned](const BakePlan& plan) {
    tell(plan);
    record_plan(plan, feed.record());
    feed.publish();
  };
  p.cell_done = [&feed, tell = callbacks.cell_done](const CellReport& report, const CellJob& job, std::size_t done,
                                                    std::size_t all) {
    tell(report, job, done, all);
    record_cell(report, feed.record());
    feed.turn();
  };
  return p;
}

int run(const BakeOptions& options, MpiSession& mpi) {
  const BakeRequest request = options.request();
  Progress progress;
  StatusFeed feed(request.out, mpi.ranks(), request.metrics, [&](const BakeStatus& s) { progress.show(s); });
  BakeSummary summary;
  try {
    summary = bake(mpi, request, with_status(progress.callbacks(), feed));
  } catch (const std::exception& e) {
    feed.fail(e.what());
    throw;
  }
  if (mpi.rank() != 0) return complete;
  const std::vector<SceneLoss>& losses = summary.scene.losses;
  feed.record().enter(losses.empty() ? BakeState::complete : BakeState::incomplete);
  feed.publish();
  const BakeStatus status = feed.record().at(unix_now_s());
  options.json ? print_json_report(summary, status, request.out) : print_report(summary, status, request.out);
  print_losses(losses);
  return losses.empty() ? complete : cells_failed;
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
  command->add_flag("--keep-going,!--no-keep-going", options->keep_going,
                    "bake the rest after a tile or cell failed (default), or stop there and publish nothing");
  command->callback(
      [options, &exit_code] { exit_code = on_all_ranks([&](MpiSession& mpi) { return run(*options, mpi); }); });
}

}  // namespace gigabake::app
