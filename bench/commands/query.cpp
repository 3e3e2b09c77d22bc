#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/with_progress.h"
#include "app/options/choices.h"
#include "app/options/scene_argument.h"
#include "bench/commands/commands.h"
#include "bench/query/query_bench.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"
#include "format/system/message.h"
#include "worker/device/backend.h"

namespace gigabake::app {
namespace {

struct QueryBenchArguments {
  bench::QueryBenchRequest request;
  std::string scene;
  Backend backend = Backend::cpu;
  int threads = 0;
  bool json = false;
};

void print_text(const bench::QueryBench& b) {
  fmt::print("{}, {} of them hit; {:.2f} million/s, {:.2f} with {} built; {:.2f} µs of one core per ray\n",
             pluralize(b.rays, "ray"), b.hits, 1e-6 * double(b.rays) / b.query_s,
             1e-6 * double(b.rays) / b.build_and_query_s, pluralize(b.trees_built, "tree"),
             1e6 * b.cpu_s / double(b.rays));
  fmt::print(
      "against Embree: {} equal, {} graze a voxel that only one of the two hits, {} begin in or at a voxel, {} wrong;\n"
      "distances differ by at most {:.2g} voxels\n",
      b.same, b.grazing, b.inside, b.wrong, b.max_gap);
  if (b.device_s > 0)
    fmt::print("GPU: {:.1f} million/s with transfers; {} of {} answers differ from the CPU's\n",
               1e-6 * double(b.rays) / b.device_s, b.differ, b.rays);
  if (!b.first_wrong.empty()) fmt::print("wrong: {}\n", b.first_wrong);
}

nlohmann::ordered_json json_of(const bench::QueryBench& b) {
  return {{"bench", "query"},       {"rays", b.rays},
          {"hits", b.hits},         {"compared_hits", b.compared_hits()},
          {"query_s", b.query_s},   {"build_and_query_s", b.build_and_query_s},
          {"cpu_s", b.cpu_s},       {"trees_built", b.trees_built},
          {"same", b.same},         {"grazing", b.grazing},
          {"inside", b.inside},     {"wrong", b.wrong},
          {"device_s", b.device_s}, {"device_rays", b.device_rays},
          {"differ", b.differ},     {"largest_gap_voxels", b.max_gap}};
}

int run(QueryBenchArguments& a) {
  if (a.threads < 0 || a.threads > 1024) throw UsageError("--threads: expected 1 to 1024, or 0 for all cores");
  a.request.scene = scene_argument(a.scene);
  a.request.threads = a.threads != 0 ? a.threads : host_limits().cores();
  a.request.device = choose_device({a.backend}).device;
  const bench::QueryBench result = while_reading([&](const Progress& progress) {
    progress.step("casting rays with gigabake and Embree");
    return bench::bench_queries(a.request);
  });
  if (a.json)
    fmt::print("{}\n", json_text(json_of(result)));
  else
    print_text(result);
  if (result.compared_hits() == 0)
    print_message("gigabake: none of the rays hit a voxel: nothing was compared; choose more --rays\n");
  return result.failed() ? failed : complete;
}

}  // namespace

void add_bench_query(CLI::App& bench, int& exit_code) {
  CLI::App& command = *bench.get_subcommand("query");
  const auto a = std::make_shared<QueryBenchArguments>();
  command.add_option("SCENE", a->scene, "folder of a bake, or its scene.xml")->required();
  command.add_option("--rays", a->request.rays, "number of rays")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000000));
  command.add_option("--lod", a->request.lod, "level of the voxels")->capture_default_str()->check(CLI::Range(0, 10));
  command.add_option("--seed", a->request.seed, "seed of the random rays")->capture_default_str();
  command.add_option("--threads", a->threads, "CPU threads (all cores)");
  command.add_option("--memory", a->request.memory_bytes, "max bytes of trees in memory, such as 512M (1G)")
      ->transform(CLI::AsSizeValue(false));
  add_choice(command, "--backend", a->backend, "cuda: time a GPU, too, and compare its answers with the CPU's");
  command.add_flag("--json", a->json, "print JSON");
  command.callback([a, &exit_code] { exit_code = run(*a); });
}

}  // namespace gigabake::app
