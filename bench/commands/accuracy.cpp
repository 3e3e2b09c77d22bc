#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <tuple>

#include "app/commands.h"
#include "app/messages/with_progress.h"
#include "app/options/bake_options.h"
#include "app/options/choices.h"
#include "app/options/output_file.h"
#include "app/options/text_values.h"
#include "bench/commands/commands.h"
#include "bench/report/accuracy_report.h"
#include "bench/report/flight_report.h"
#include "bench/report/hard_report.h"
#include "bench/report/leak_report.h"
#include "bench/report/light_report.h"
#include "bench/report/motion_report.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"
#include "format/system/message.h"
#include "format/system/publish.h"

namespace gigabake::app {
namespace {

struct AccuracyOptions {
  BakeOptions bake;
  std::string json, markdown, size = "160x120";
  int samples = 64, repeats = 3, million_triangles = 17, scene_voxels = 1536;
  std::uint64_t voxels = 50000;
  std::vector<std::string> settings, families;
  std::vector<double> scales = bench::accuracy_scales, steps_m = bench::AccuracyBenchRequest().steps_m;
  bool hard = false, leaks = false, light = false, motion = false, flight = false;
};

int threads_of(const BakeOptions& bake) { return bake.asked.threads > 0 ? bake.asked.threads : host_limits().cores(); }

std::pair<int, int> picture_size(const AccuracyOptions& options) {
  const auto [width, height] = size_option(options.size);
  if (std::min(width, height) < 8 || std::max(width, height) > 4096)
    throw UsageError("--size: expected 8 to 4096 pixels per side");
  return {width, height};
}

bench::AccuracyBenchRequest request_of(const AccuracyOptions& options) {
  const BakeRequest bake = options.bake.request();
  bench::AccuracyBenchRequest r;
  r.scene = {bake.source, bake.source_options, bake.parameters, threads_of(options.bake), bake.memory_bytes};
  r.out = bake.out;
  r.backend = bake.backend;
  r.samples = options.samples;
  r.only = options.settings;
  r.scales = options.scales;
  r.steps_m = options.steps_m;
  r.sample.voxels = options.voxels;
  r.sample.points = 4 * options.voxels;
  r.repeats = options.repeats;
  std::tie(r.width, r.height) = picture_size(options);
  return r;
}

/// The folder of the suite's bakes: a temporary folder that the destructor removes, or the named folder, which is kept.
class SuiteFolder {
 public:
  explicit SuiteFolder(const std::string& name) : path_(name), is_kept_(!name.empty()) {
    if (is_kept_) return;
    std::string made = (std::filesystem::temp_directory_path() / "gigabake-suite-XXXXXX").string();
    if (mkdtemp(made.data()) == nullptr) throw InputError(made, "", "cannot make the folder; name one with -o");
    path_ = made;
  }
  ~SuiteFolder() {
    std::error_code ignored;
    if (!is_kept_) std::filesystem::remove_all(path_, ignored);
  }
  SuiteFolder(const SuiteFolder&) = delete;
  SuiteFolder& operator=(const SuiteFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool is_kept_;
};

/// Prints the results to the terminal, and writes the files that the options name.
template <class Bench>
void publish(const Bench& b, const AccuracyOptions& options) {
  const std::string markdown = to_markdown(b);
  if (!options.json.empty()) publish_file(options.json, to_json(b));
  if (!options.markdown.empty()) publish_file(options.markdown, markdown);
  fmt::print("{}", markdown);
}

int run_hard(const AccuracyOptions& options) {
  if (!options.bake.source.empty()) throw UsageError("--hard generates its scenes: expected no SOURCE");
  const SuiteFolder folder(options.bake.out);
  const bench::HardBenchRequest request{folder.path(), options.bake.asked.backend, threads_of(options.bake),
                                        options.million_triangles};
  const bench::HardBench b = with_progress([&](const Progress& progress) {
    progress.step("hard cases", 0, "case");
    return bench_hard(request, [&](const bench::HardResult& r) {
      if (!r.holds()) print_message("{} FAILS\n", r.name);
      progress.advance();
    });
  });
  publish(b, options);
  return b.holds() ? complete : failed;
}

bench::LeakBenchRequest leak_request_of(const AccuracyOptions& options, const std::filesystem::path& folder) {
  bench::LeakBenchRequest r;
  r.out = folder;
  r.keep = !options.bake.out.empty();
  r.backend = options.bake.asked.backend;
  r.threads = threads_of(options.bake);
  r.edge = options.scene_voxels;
  r.families = options.families;
  r.samples = options.samples;
  std::tie(r.width, r.height) = picture_size(options);
  return r;
}

/// Prints a line and returns `failed` if scenes were not measured.
int expect_measured(const bench::LeakBench& b) {
  const std::vector<std::string> unmeasured = b.unmeasured();
  if (unmeasured.empty()) return complete;
  print_message(
      "gigabake: `{}`{} shows fewer than {} inner pixels: nothing was measured; choose smaller voxels, wider "
      "scenes (--scene-voxels) or a larger --size\n",
      unmeasured.front(),
      unmeasured.size() > 1 ? fmt::format(" and {} more", pluralize(unmeasured.size() - 1, "scene")) : "",
      bench::min_inner_pixels);
  return failed;
}

/// Measures leaks. Fails only if a scene was not measured; leaks beyond their bounds are only reported.
int run_leaks(const AccuracyOptions& options) {
  const bool is_given = !options.bake.source.empty();
  if (is_given && options.bake.voxel_size.empty()) throw UsageError("--leaks with a SOURCE: expected --voxel-size");
  if (is_given && !options.families.empty()) throw UsageError("--scenes selects generated scenes: expected no SOURCE");
  const SuiteFolder folder(options.bake.out);
  const bench::LeakBenchRequest request = leak_request_of(options, folder.path());
  const bench::LeakBench b = with_progress([&](const Progress& progress) {
    if (!is_given) return bench::bench_leaks(request, [&](const std::string& scene) { progress.step(scene); });
    bench::BenchScene scene = request_of(options).scene;
    scene.progress = progress;
    return bench::bench_leaks_of(scene, request);
  });
  publish(b, options);
  return expect_measured(b);
}

/// Runs a benchmark of images: bench_light(), bench_motion() or bench_flight(). Checks no bounds;
/// docs/accuracy-rendering.md states the goals.
template <class Bench>
int run_pictures(const AccuracyOptions& options,
                 Bench (*bench)(const bench::AccuracyBenchRequest&, const bench::AccuracyProgress&)) {
  const SuiteFolder folder(options.bake.out);
  bench::AccuracyBenchRequest request = request_of(options);
  request.out = folder.path();
  const Bench b = with_progress([&](const Progress& progress) {
    request.scene.progress = progress;
    return bench(request, [&](const std::string& view) { progress.step(view); });
  });
  publish(b, options);
  return complete;
}

/// Checks the output files before the measurement. They may lie in the folder of -o, which the command creates.
void check_files(const AccuracyOptions& options) {
  for (const auto& [option, file] : {std::pair("--json", options.json), {"--markdown", options.markdown}}) {
    expect_no_input(option, file, {options.bake.source});
    expect_parent_folder(option, file, options.bake.out);
  }
}

int run(const AccuracyOptions& options) {
  check_files(options);
  if (options.hard) return run_hard(options);
  if (options.leaks) return run_leaks(options);
  if (options.bake.source.empty() || options.bake.out.empty() || options.bake.voxel_size.empty())
    throw UsageError("expected SOURCE, -o and --voxel-size, or --hard, or --leaks");
  if (options.light) return run_pictures(options, bench::bench_light);
  if (options.motion) return run_pictures(options, bench::bench_motion);
  if (options.flight) return run_pictures(options, bench::bench_flight);
  bench::AccuracyBenchRequest request = request_of(options);
  const bench::AccuracyBench b = with_progress([&](const Progress& progress) {
    request.scene.progress = progress;
    return bench::bench_accuracy(request, [&](const std::string& setting) { progress.step(setting); });
  });
  publish(b, options);
  return complete;
}

}  // namespace

void add_bench_accuracy(CLI::App& bench, int& exit_code) {
  auto* command = bench.get_subcommand("accuracy");
  auto o = std::make_shared<AccuracyOptions>();
  BakeOptions& bake = o->bake;
  command->add_option("SOURCE", bake.source, "input of the bakes: see below");
  command->add_option("-o,--out", bake.out, "folder for bakes and images, which are replaced");
  command->add_option("--voxel-size", bake.voxel_size,
                      "edge of a voxel, metres; half of the settings use twice this edge");
  auto* hard = command->add_flag(
      "--hard", o->hard,
      "run the suite of hard cases and of surfaces of real scenes instead, which needs no SOURCE; exit code 1 if a "
      "claimed bound does not hold");
  command
      ->add_flag("--leaks", o->leaks,
                 "measure light through opaque surfaces instead, from each side and distance; without SOURCE: through "
                 "generated planes, hills, steps, walls, a house, translucent surfaces, wires, a tree crown, slopes "
                 "under plants, decals and glass, and surfaces of mixed winding")
      ->excludes(hard);
  command
      ->add_flag("--motion", o->motion,
                 "measure motion instead: the difference between frames that are a fraction of a pixel apart on fixed "
                 "paths, for voxels with and without blended levels, and for triangles")
      ->excludes(hard);
  command
      ->add_flag("--light", o->light,
                 "measure lighting instead: sun and sky with shadows, compared with shadowed triangles, and the time "
                 "of frames with and without shadows")
      ->excludes(hard);
  auto* flight = command->add_flag(
      "--flight", o->flight,
      "measure flights instead: frame times and errors at several speeds, at 60 and 120 Hz, and still images of voxels "
      "and of a mesh with levels of one pixel of error, compared with triangles");
  flight->excludes(hard);
  command->add_option("--steps", o->steps_m, "metres that the eye moves per frame of --flight, separated by commas")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e6))
      ->needs(flight);
  command
      ->add_option("--scene-voxels", o->scene_voxels,
                   "width of the scenes of --leaks in voxels; distant views include only scenes that are at least 24 "
                   "pixels wide")
      ->capture_default_str()
      ->check(CLI::Range(32, 32768));
  command->add_option("--scenes", o->families, "classes of scenes for --leaks, separated by commas (all)")
      ->delimiter(',')
      ->check(one_of(bench::leak_families()));
  command
      ->add_option("--million-triangles", o->million_triangles,
                   "millions of triangles of the hard case that has all triangles in one voxel")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--cell-voxels", bake.asked.parameters.cell_voxels,
                   "edge of a cell in voxels, a power of two from 8 to 8192")
      ->capture_default_str();
  add_choice(*command, "--up", bake.asked.source_options.scene_up,
             "axis that points up in the source (tilesets z, mesh files y)");
  command->add_flag("--local", bake.asked.source_options.local,
                    "no georeference: use the source's frame, rotated to z up");
  command->add_option("--threads", bake.asked.threads, "CPU threads (all cores)");
  add_choice(*command, "--backend", bake.asked.backend, "backend of the bakes; auto: a GPU if there is one");
  command->add_option("--samples", o->samples, "rays per pixel of the reference")
      ->capture_default_str()
      ->check(CLI::Range(1, 65536));
  command->add_option("--settings", o->settings, "settings to measure, separated by commas (all)")
      ->delimiter(',')
      ->check(one_of(bench::accuracy_setting_names()));
  command
      ->add_option("--voxels", o->voxels,
                   "max voxels of each setting to compare with the triangles; four times as many points of the surface "
                   "are compared")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000000));
  command->add_option("--repeats", o->repeats, "number of bakes of each setting; the fastest is reported")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--scales", o->scales, "scales of the images in voxels per pixel, separated by commas")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(1.0 / 16, 65536.0));
  command->add_option("--size", o->size, "WIDTHxHEIGHT of the largest images")->capture_default_str();
  command->add_option("--json", o->json, "JSON file to write: all results");
  command->add_option("--markdown", o->markdown, "Markdown file to write: the printed tables");
  command->callback([o, &exit_code] { exit_code = run(*o); });
}

}  // namespace gigabake::app
