#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/bake_options.h"
#include "app/commands.h"
#include "app/progress.h"
#include "format/error.h"

namespace gigabake::app {
namespace {

/// Kernel working memory of a cell and its time on one core, from the triangles alone: 2.1 million triangles at 2048³
/// take 307 MB and 3.6 core seconds; both follow voxels as much as triangles, so these are orders of magnitude.
constexpr double bytes_per_triangle = 150, core_seconds_per_triangle = 1.7e-6;

void print_json(const BakePlan& plan) {
  nlohmann::ordered_json j;
  j["cells"] = plan.jobs.size();
  j["triangles"] = plan.triangles;
  j["dropped"] = {{"non_finite", plan.non_finite}, {"zero_area", plan.zero_area}};
  j["skipped"] = {{"points", plan.skipped_points}, {"lines", plan.skipped_lines}};
  j["jobs"] = nlohmann::ordered_json::array();
  for (const CellJob& job : plan.jobs)
    j["jobs"].push_back({{"name", job.name},
                         {"lattice_min", job.lattice_min},
                         {"tiles", job.tiles.size()},
                         {"triangles", job.triangles},
                         {"fingerprint", job.fingerprint.hex()}});
  j["losses"] = nlohmann::ordered_json::array();
  for (const SceneLoss& l : plan.losses) j["losses"].push_back({{"name", l.name}, {"reason", l.reason}});
  fmt::print("{}\n", j.dump(2));
}

void print_text(const BakePlan& plan) {
  std::uint64_t largest = 0, all = 0;
  for (const CellJob& job : plan.jobs) {
    largest = std::max(largest, job.triangles);
    all += job.triangles;
  }
  fmt::print("{} cells, {} triangles, {} of them in the largest cell\n", plan.jobs.size(), plan.triangles, largest);
  fmt::print("about {} of kernel memory for the largest cell, {:.0f} core seconds in all\n",
             readable_bytes(std::uint64_t(bytes_per_triangle * double(largest))),
             core_seconds_per_triangle * double(all));
  for (const CellJob& job : plan.jobs)
    fmt::print("  {:<24} lattice {} {} {}  {} tiles  {} triangles\n", job.name, job.lattice_min[0], job.lattice_min[1],
               job.lattice_min[2], job.tiles.size(), job.triangles);
  for (const SceneLoss& l : plan.losses) fmt::print("missing {}: {}\n", l.name, l.reason);
}

int run(const BakeOptions& options) {
  MpiSession mpi;
  int code = complete;
  try {
    const BakeRequest request = options.request();
    Progress progress;
    const BakePlan plan = plan_bake(mpi, request, progress.callbacks());
    if (mpi.rank() == 0) {
      options.json ? print_json(plan) : print_text(plan);
      code = plan.losses.empty() ? complete : cells_failed;
    }
  } catch (const OtherRankFailed&) {
    return failed;
  } catch (const InputError& e) {  // every rank fails alike: no need to abort the others
    fmt::print(stderr, "gigabake: {}\n", e.what());
    return failed;
  } catch (const UsageError& e) {
    if (mpi.rank() == 0) fmt::print(stderr, "gigabake: {}\n", e.what());
    return usage;
  }
  return mpi.from_master(code);
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("plan", "What a bake would do: cells, triangles, memory, time; bakes nothing");
  auto options = std::make_shared<BakeOptions>();
  options->add_to(*command);
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace gigabake::app
