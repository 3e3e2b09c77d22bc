#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <thread>
#include <tuple>

#include "app/bake_options.h"
#include "app/commands.h"
#include "app/text_values.h"
#include "bench/accuracy_report.h"
#include "format/error.h"
#include "format/publish.h"

namespace gigabake::app {
namespace {

struct AccuracyOptions {
  BakeOptions bake;
  std::string json, markdown, size = "160x120";
  int samples = 64, repeats = 3;
};

bench::AccuracyBenchRequest request_of(const AccuracyOptions& options) {
  const BakeRequest bake = options.bake.request();
  bench::AccuracyBenchRequest r;
  const int threads = bake.threads > 0 ? bake.threads : std::max(1, int(std::thread::hardware_concurrency()));
  r.scene = {bake.source, bake.source_options, bake.parameters, threads, bake.memory_bytes};
  r.out = bake.out;
  r.backend = bake.backend;
  r.samples = options.samples;
  r.repeats = options.repeats;
  std::tie(r.width, r.height) = size_option(options.size);
  if (std::min(r.width, r.height) < 8 || std::max(r.width, r.height) > 4096)
    throw UsageError("--size: expected 8 to 4096 pixels a side");
  return r;
}

int run(const AccuracyOptions& options) {
  const bench::AccuracyBench b = bench::bench_accuracy(
      request_of(options), [](const std::string& setting) { fmt::print(stderr, "{}\n", setting); });
  const std::string markdown = to_markdown(b);
  if (!options.json.empty()) publish_file(options.json, to_json(b));
  if (!options.markdown.empty()) publish_file(options.markdown, markdown);
  for (const bench::NamedPlot& plot : plots_of(b))
    publish_file(std::filesystem::path(options.bake.out) / plot.file, to_svg(plot.plot));
  fmt::print("{}", markdown);
  return complete;
}

}  // namespace

void add_bench_accuracy(CLI::App& bench, int& exit_code) {
  auto* command =
      bench.add_subcommand("accuracy", "Speed against error: many settings, each against pictures of the triangles");
  auto o = std::make_shared<AccuracyOptions>();
  BakeOptions& bake = o->bake;
  command->add_option("SCENE", bake.source, "as bake takes it")->required();
  command->add_option("-o,--out", bake.out, "folder for bakes, pictures and plots, which are replaced")->required();
  command->add_option("--voxel-size", bake.voxel_size, "metres; half of the settings have voxels of twice that")
      ->required();
  command->add_option("--cell-voxels", bake.cell_voxels, "edge of a cell in voxels, a power of two from 8 to 8192")
      ->capture_default_str();
  command->add_option("--up", bake.up, "axis that points up in the source: x, y or z (tilesets z, mesh files y)");
  command->add_flag("--local", bake.local, "no georeference: the source's own frame, turned to z up");
  command->add_option("--threads", bake.threads, "all cores unless said otherwise");
  command->add_option("--backend", bake.backend, "where cells are baked: auto, cpu or cuda")->capture_default_str();
  command->add_option("--samples", o->samples, "rays of the reference, a pixel")
      ->capture_default_str()
      ->check(CLI::Range(1, 65536));
  command->add_option("--repeats", o->repeats, "bakes of each setting; the fastest counts")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--size", o->size, "WIDTHxHEIGHT of the largest pictures")->capture_default_str();
  command->add_option("--json", o->json, "JSON file to write: all figures");
  command->add_option("--markdown", o->markdown, "Markdown file to write: the tables that are printed");
  command->callback([o, &exit_code] { exit_code = run(*o); });
}

}  // namespace gigabake::app
