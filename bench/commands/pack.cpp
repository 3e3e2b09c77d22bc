#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/status_text.h"
#include "bench/commands/commands.h"
#include "bench/pack_bench.h"
#include "core/base/pluralize.h"

namespace gigabake::app {
namespace {

void print_line(const std::string& name, const bench::ColumnPacking& p) {
  const double raw = double(p.raw_bytes);
  fmt::print("{:<16} {:>7} {:>13}  {:6.2f} % {:7.0f} MB/s  {:6.2f} % {:7.0f} MB/s  {:.3f}\n", name, p.chunks,
             p.raw_bytes, 100 * double(p.bytes) / raw, 1e-6 * raw / p.seconds, 100 * double(p.libdeflate_bytes) / raw,
             1e-6 * raw / p.libdeflate_seconds, double(p.bytes) / double(p.libdeflate_bytes));
}

void print_pack_text(const bench::PackBench& b) {
  fmt::print("{:<16} {:>7} {:>13}  {:>21}  {:>21}  bytes\n", "column", "chunks", "raw bytes", "one core",
             "libdeflate 1");
  for (const auto& [name, packing] : b.columns) print_line(name, packing);
  print_line("all", b.all);
  if (b.device_reason.empty()) {
    fmt::print("device: {:.3f} ms, {:.1f} GB/s, {} of memory\n", 1e3 * b.device_seconds(),
               1e-9 * double(b.all.raw_bytes) / b.device_seconds(), readable_bytes(b.device.peak_bytes));
    for (std::size_t i = 0; i < kernels::pack_steps.size(); ++i)
      fmt::print("  {:<10} {:9.3f} ms of the last batch\n", kernels::pack_steps[i], 1e3 * b.device.step_seconds[i]);
  } else {
    fmt::print("device: {}\n", b.device_reason);
  }
  fmt::print("{}\n", b.differ ? "the packed data DIFFER" : "all results are equal, and unpacking restores the input");
}

void print_pack_json(const bench::PackBench& b) {
  const auto packing = [](const bench::ColumnPacking& p) {
    return nlohmann::ordered_json{{"chunks", p.chunks},
                                  {"raw_bytes", p.raw_bytes},
                                  {"bytes", p.bytes},
                                  {"core_s", p.seconds},
                                  {"libdeflate_bytes", p.libdeflate_bytes},
                                  {"libdeflate_core_s", p.libdeflate_seconds}};
  };
  nlohmann::ordered_json j{{"bench", "pack"}, {"all", packing(b.all)}};
  for (const auto& [name, p] : b.columns) j["columns"][name] = packing(p);
  if (b.device_reason.empty()) {
    j["device"] = {{"seconds", b.device.seconds}, {"peak_bytes", b.device.peak_bytes}};
    for (std::size_t i = 0; i < kernels::pack_steps.size(); ++i)
      j["device"]["last_batch_s"][kernels::pack_steps[i]] = b.device.step_seconds[i];
  }
  j["differ"] = b.differ;
  fmt::print("{}\n", json_text(j));
}

}  // namespace

void add_bench_pack(CLI::App& bench, int& exit_code) {
  auto* command = bench.get_subcommand("pack");
  struct Options {
    bench::PackBenchRequest request;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  command->add_option("shards", options->request.shards, "folder with shards; their chunks are compressed again")
      ->required()
      ->check(CLI::ExistingDirectory);
  command->add_option("--repeats", options->request.repeats, "number of runs; the fastest is reported")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--most-bytes", options->request.max_bytes, "max raw bytes to compress, from the first shards")
      ->capture_default_str();
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options, &exit_code] {
    const bench::PackBench b = bench::bench_pack(options->request);
    options->json ? print_pack_json(b) : print_pack_text(b);
    exit_code = b.differ ? failed : complete;
  });
}

}  // namespace gigabake::app
