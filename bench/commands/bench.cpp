#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/status_text.h"
#include "app/messages/with_progress.h"
#include "app/options/bake_options.h"
#include "app/process/bench_program.h"
#include "bench/bake_bench.h"
#include "bench/commands/commands.h"
#include "bench/kernel_bench.h"
#include "bench/schedule_bench.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"
#include "kernels/cuda/baker.h"

namespace gigabake::app {
namespace {

struct Stage {
  const char* name;
  double seconds;
};

std::vector<Stage> stages(const kernels::CellStats& s) {
  return {{"snap", s.snap_s}, {"bin", s.bin_s},   {"sort", s.sort_s},  {"voxelize", s.voxelize_s},
          {"mip", s.mip_s},   {"hash", s.hash_s}, {"prune", s.prune_s}};
}

void print_text(const bench::KernelBench& b) {
  fmt::print("cell {}: {} at lod 0, {} in all, {}\n", b.cell, pluralize(b.voxels_lod0, "voxel"), b.voxels,
             pluralize(b.bricks, "brick"));
  fmt::print("input {}, output {}", readable_bytes(b.input_bytes), readable_bytes(b.output_bytes));
  if (b.floor_s() > 0)
    fmt::print("; copying both once at {:.2f} TB/s takes {:.4f} ms", b.copy_bytes_per_s * 1e-12, 1e3 * b.floor_s());
  fmt::print("\n");
  for (const bench::BackendTimes& t : b.times) {
    const kernels::CellStats& s = t.stats;
    fmt::print("\n{}: {:.3f} ms, {:.0f} million voxels/s, {:.0f} million fragments/s", t.backend, 1e3 * t.total_s,
               1e-6 * double(b.voxels) / t.total_s, 1e-6 * double(s.fragments) / t.total_s);
    if (b.floor_s() > 0 && t.backend == "cuda") fmt::print(", {:.1f} × this lower bound", t.total_s / b.floor_s());
    fmt::print("\n");
    for (const Stage& stage : stages(s))
      fmt::print("  {:<10} {:9.3f} ms  {:4.0f} %\n", stage.name, 1e3 * stage.seconds, 100 * stage.seconds / t.total_s);
    if (t.transfer_s > 0) fmt::print("  {:<10} {:9.3f} ms, not counted\n", "transfers", 1e3 * t.transfer_s);
    fmt::print("  {}, {}, {}; working memory {} ({:.2f} × input and output)\n", pluralize(s.triangles, "triangle"),
               pluralize(s.pairs, "pair"), pluralize(s.fragments, "fragment"), readable_bytes(s.peak_bytes),
               double(s.peak_bytes) / double(b.input_bytes + b.output_bytes));
    fmt::print("  content hash {}\n", t.content_hash);
  }
  if (b.times.size() > 1)
    fmt::print("\nthe results of the backends {}\n", b.differ ? "DIFFER" : "are equal in all bits");
}

void print_json(const bench::KernelBench& b) {
  nlohmann::ordered_json j{{"bench", "kernels"},
                           {"cell", b.cell},
                           {"voxels_lod0", b.voxels_lod0},
                           {"voxels", b.voxels},
                           {"bricks", b.bricks},
                           {"input_bytes", b.input_bytes},
                           {"output_bytes", b.output_bytes},
                           {"copy_bytes_per_s", b.copy_bytes_per_s},
                           {"floor_s", b.floor_s()},
                           {"differ", b.differ}};
  j["backends"] = nlohmann::ordered_json::array();
  for (const bench::BackendTimes& t : b.times) {
    nlohmann::ordered_json times{{"backend", t.backend},           {"total_s", t.total_s},
                                 {"transfer_s", t.transfer_s},     {"peak_bytes", t.stats.peak_bytes},
                                 {"triangles", t.stats.triangles}, {"pairs", t.stats.pairs},
                                 {"fragments", t.stats.fragments}, {"content_hash", t.content_hash}};
    for (const Stage& stage : stages(t.stats)) times["seconds"][stage.name] = stage.seconds;
    j["backends"].push_back(times);
  }
  fmt::print("{}\n", json_text(j));
}

void print_text(const bench::BakeBench& b) {
  const auto line = [](const char* name, const bench::StageSeconds& s) {
    fmt::print("  {:<11} read {:7.2f} s  kernels {:7.2f} s  write {:7.2f} s\n", name, s.read, s.kernels, s.write);
  };
  fmt::print("{}, kernels on {}: {}, {}, {}\n", pluralize(b.cells, "cell"), b.backend,
             pluralize(b.triangles, "triangle"), pluralize(b.voxels, "voxel"), readable_bytes(b.bytes));
  line("one by one", b.alone);
  line("overlapped", b.overlapped);
  fmt::print("{:.2f} s overlapped, {:.2f} × the time of its slowest stage ({}); {:.1f} million voxels/s\n", b.bake_s,
             b.bake_s / b.alone.slowest(), b.alone.slowest_name(), 1e-6 * double(b.voxels) / b.bake_s);
  fmt::print("content hash {}{}\n", b.content_hash, b.differ ? ", and the two runs DIFFER" : " in both runs");
}

void print_json(const bench::BakeBench& b) {
  const auto seconds = [](const bench::StageSeconds& s) {
    return nlohmann::ordered_json{{"read", s.read}, {"kernels", s.kernels}, {"write", s.write}};
  };
  const nlohmann::ordered_json j{{"bench", "bake"},
                                 {"backend", b.backend},
                                 {"cells", b.cells},
                                 {"triangles", b.triangles},
                                 {"voxels", b.voxels},
                                 {"bytes", b.bytes},
                                 {"alone_s", seconds(b.alone)},
                                 {"overlapped_s", seconds(b.overlapped)},
                                 {"bake_s", b.bake_s},
                                 {"slowest_stage", b.alone.slowest_name()},
                                 {"ratio", b.bake_s / b.alone.slowest()},
                                 {"content_hash", b.content_hash},
                                 {"differ", b.differ}};
  fmt::print("{}\n", json_text(j));
}

void print_text(const bench::ScheduleBench& b) {
  fmt::print("{}, {}, seed {}: planned in {:.2f} s\n", pluralize(b.cells, "cell"), pluralize(b.workers, "worker"),
             b.seed, b.plan_s);
  fmt::print("makespan {:.2f} s, {:.4f} × the lower bound of {:.2f} s\n", b.makespan_s, b.ratio(), b.lower_bound_s);
  fmt::print(
      "cells dispatched {} times, {} of them repeated, {} to a worker that had read a tile of the cell; {}, {} lost\n",
      b.dispatches, b.retries, b.followers, pluralize(b.stale, "late result"), pluralize(b.lost_workers, "worker"));
  fmt::print("{} done, {} failed, {} abandoned{}\n", b.counts.done, b.counts.failed, b.counts.abandoned,
             b.differ ? ", which DIFFERS from the results of the workers" : "");
  fmt::print("{:.0f} dispatches/s of scheduling, peak memory {}\n", b.dispatches_per_s(),
             readable_bytes(b.peak_rss_bytes));
}

void print_json(const bench::ScheduleBench& b) {
  const nlohmann::ordered_json j{{"bench", "schedule"},
                                 {"cells", b.cells},
                                 {"workers", b.workers},
                                 {"seed", b.seed},
                                 {"plan_s", b.plan_s},
                                 {"makespan_s", b.makespan_s},
                                 {"lower_bound_s", b.lower_bound_s},
                                 {"ratio", b.ratio()},
                                 {"dispatches", b.dispatches},
                                 {"retries", b.retries},
                                 {"followers", b.followers},
                                 {"stale", b.stale},
                                 {"lost_workers", b.lost_workers},
                                 {"done", b.counts.done},
                                 {"failed", b.counts.failed},
                                 {"abandoned", b.counts.abandoned},
                                 {"schedule_s", b.schedule_s},
                                 {"dispatches_per_s", b.dispatches_per_s()},
                                 {"peak_rss_bytes", b.peak_rss_bytes},
                                 {"differ", b.differ}};
  fmt::print("{}\n", json_text(j));
}

bench::BenchScene scene_of(const BakeRequest& request) {
  const int threads = request.threads > 0 ? request.threads : host_limits().cores();
  return {request.source, request.source_options, request.parameters, threads, request.memory_bytes};
}

template <class Bench>
int print(const Bench& b, bool json) {
  json ? print_json(b) : print_text(b);
  return b.differ ? failed : complete;
}

struct BakeBenchOptions {
  BakeOptions bake;
  std::size_t cells = 16;
};

int run(const BakeBenchOptions& options) {
  const BakeRequest request = options.bake.request();
  bench::BakeBenchRequest r;
  r.scene = scene_of(request);
  r.out = request.out;
  r.backend = request.backend;
  r.max_cells = options.cells;
  const bench::BakeBench b = with_progress([&](const Progress& progress) {
    r.scene.progress = progress;
    return bench::bench_bake(r);
  });
  return print(b, options.bake.json);
}

void add_bench_bake(CLI::App& bench, int& exit_code) {
  auto* command = bench.get_subcommand("bake");
  auto options = std::make_shared<BakeBenchOptions>();
  options->bake.add_to(*command);
  command->add_option("-o,--out", options->bake.out, "folder for the shards, which are replaced")->required();
  command->add_option("--cells", options->cells, "number of cells, from the first of the plan")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

struct KernelOptions {
  BakeOptions bake;
  int repeats = 5;
};

int run(const KernelOptions& options) {
  const BakeRequest request = options.bake.request();
  bench::KernelBenchRequest r;
  r.scene = scene_of(request);
  r.repeats = options.repeats;
  const bool has_device = !kernels::cuda_devices().usable.empty();
  r.cpu = request.backend != Backend::cuda;
  r.cuda = request.backend == Backend::cuda || (request.backend == Backend::automatic && has_device);
  const bench::KernelBench b = while_reading([&](const Progress& progress) {
    r.scene.progress = progress;
    return bench::bench_kernels(r);
  });
  return print(b, options.bake.json);
}

void add_bench_kernels(CLI::App& bench, int& exit_code) {
  auto* command = bench.get_subcommand("kernels");
  auto options = std::make_shared<KernelOptions>();
  options->bake.add_to(*command);
  command->add_option("--repeats", options->repeats, "number of runs; the fastest is reported")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

struct ScheduleBenchOptions {
  bench::ScheduleBenchRequest request;
  bool json = false;
};

void add_bench_schedule(CLI::App& bench, int& exit_code) {
  auto* command = bench.get_subcommand("schedule");
  auto options = std::make_shared<ScheduleBenchOptions>();
  bench::ScheduleBenchRequest& r = options->request;
  const auto add = [command](const char* name, auto& value, int minimum, int maximum, const char* text) {
    command->add_option(name, value, text)->capture_default_str()->check(CLI::Range(minimum, maximum));
  };
  add("--cells", r.cells, 1, 100000000, "cells of the terrain");
  add("--workers", r.workers, 1, 1000000, "number of workers");
  command->add_option("--seed", r.seed, "seed of terrain, times and failures")->capture_default_str();
  add("--deaths", r.deaths, 0, 1000000, "number of bake processes that die at random times");
  add("--silences", r.silences, 0, 1000000, "number of workers that stop sending for a while, at random times");
  add("--failing-cells", r.failing_cells, 0, 1000000, "number of cells that fail in each attempt");
  add("--killing-cells", r.killing_cells, 0, 1000000, "number of cells that kill their process in each attempt");
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options, &exit_code] {
    const bench::ScheduleBench b = while_reading([&](const Progress& progress) {
      progress.step("scheduling synthetic cells");
      return bench::bench_schedule(options->request);
    });
    exit_code = print(b, options->json);
  });
}

}  // namespace

void add_bench(CLI::App& program, int& exit_code) {
  CLI::App& bench = declare_bench(program);
  add_bench_kernels(bench, exit_code);
  add_bench_bake(bench, exit_code);
  add_bench_schedule(bench, exit_code);
  add_bench_pack(bench, exit_code);
  add_bench_query(bench, exit_code);
  add_bench_render(bench, exit_code);
  add_bench_edit(bench, exit_code);
  add_bench_accuracy(bench, exit_code);
}

}  // namespace gigabake::app
