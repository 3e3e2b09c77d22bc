#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <tuple>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/status_text.h"
#include "app/messages/with_progress.h"
#include "app/options/choices.h"
#include "app/options/renderer_options.h"
#include "app/options/scene_argument.h"
#include "app/options/text_values.h"
#include "bench/commands/commands.h"
#include "bench/commands/frames.h"
#include "bench/commands/live.h"
#include "bench/first_hit/first_hit_bench.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"
#include "format/system/message.h"

namespace gigabake::app {
namespace {

using app::print_text;
using app::to_json;

struct RenderBenchOptions {
  std::string scene, size = "1920x1080", what = "all";
  RendererArguments renderer;
  int repeats = 20, lod = 0, flight_frames = 200;
  double upload_ms = 8;
  std::size_t reference_rays = 2000;
  bool json = false;
};

void parse_size(const std::string& text, bench::FirstHitBenchRequest& request) {
  std::tie(request.width, request.height) = size_option(text);
  if (request.width < 1 || request.height < 1 || request.width > 16384 || request.height > 16384)
    throw UsageError(fmt::format("--size: expected WIDTHxHEIGHT of 1 to 16384 pixels, got '{}'", text));
}

bench::FirstHitBenchRequest request_of(const RenderBenchOptions& options, const FrameRenderer::Options& renderer) {
  bench::FirstHitBenchRequest request;
  request.scene = options.scene;
  request.lod = options.lod;
  parse_size(options.size, request);
  request.repeats = options.repeats;
  request.threads = renderer.threads > 0 ? renderer.threads : host_limits().cores();
  request.cpu = options.renderer.backend != Backend::cuda;
  request.device = renderer.cuda_device;
  request.reference_rays = options.reference_rays;
  return request;
}

double mrays_per_s(const bench::FirstHitRow& row, double seconds) { return 1e-6 * double(row.rays) / seconds; }

void print_text(const bench::FirstHitBench& b) {
  fmt::print("first hits, lod {}: {}, {}, {} ({} with colours and normals), built in {:.2f} s\n", b.lod,
             pluralize(b.voxels, "voxel"), pluralize(b.nodes, "node"), readable_bytes(b.tree_bytes),
             readable_bytes(b.bytes), b.build_s);
  fmt::print("{}×{} rays; Mrays/s\n\n", b.width, b.height);
  fmt::print("{:<20} {:>5} {:>4}  {:<7} {:>9} {:>9} {:>12} {:>9} {:>7} {:>8} {:>5}\n", "view", "hit", "beam", "backend",
             "best", "median", "with colour", "median", "differ", "rounded", "wrong");
  for (const bench::FirstHitRow& row : b.rows)
    for (const bench::FirstHitTimes& t : row.times)
      fmt::print("{:<20} {:>4.0f}% {:>4}  {:<7} {:>9.1f} {:>9.1f} {:>12.1f} {:>9.1f} {:>7} {:>8} {:>5}\n", row.view,
                 100 * double(row.hits) / double(row.rays), row.beam_tile, t.backend, mrays_per_s(row, t.best_s),
                 mrays_per_s(row, t.median_s), mrays_per_s(row, t.best_with_looks_s),
                 mrays_per_s(row, t.median_with_looks_s), row.differ, row.within_rounding, row.wrong);
  fmt::print(
      "\ndiffer: hits whose bits differ between the backends; rounded, wrong: of the {} per view that were\n"
      "compared with double precision, those with an error up to 2^-20 of the tree's edge, and those with more\n",
      pluralize(b.rows.empty() ? 0 : b.rows[0].reference_rays, "hit"));
}

nlohmann::ordered_json to_json(const bench::FirstHitBench& b) {
  nlohmann::ordered_json first{{"lod", b.lod},     {"voxels", b.voxels},
                               {"nodes", b.nodes}, {"tree_bytes", b.tree_bytes},
                               {"bytes", b.bytes}, {"build_s", b.build_s}};
  first["views"] = nlohmann::ordered_json::array();
  for (const bench::FirstHitRow& row : b.rows) {
    nlohmann::ordered_json view{{"view", row.view},
                                {"rays", row.rays},
                                {"hits", row.hits},
                                {"beam_tile", row.beam_tile},
                                {"differ", row.differ},
                                {"reference_rays", row.reference_rays},
                                {"within_rounding", row.within_rounding},
                                {"wrong", row.wrong}};
    for (const bench::FirstHitTimes& t : row.times)
      view["backends"].push_back({{"backend", t.backend},
                                  {"best_s", t.best_s},
                                  {"median_s", t.median_s},
                                  {"best_with_looks_s", t.best_with_looks_s},
                                  {"median_with_looks_s", t.median_with_looks_s}});
    first["views"].push_back(view);
  }
  return first;
}

/// Returns a request with the settings that all image benchmarks share.
template <class Request>
Request pictures_of(const bench::FirstHitBenchRequest& rays, const FrameRenderer::Options& renderer) {
  Request request;
  request.scene = rays.scene;
  request.width = rays.width;
  request.height = rays.height;
  request.renderer = renderer;
  return request;
}

bench::FrameBenchRequest frames_of(const RenderBenchOptions& options, const bench::FirstHitBenchRequest& rays,
                                   const FrameRenderer::Options& renderer) {
  auto request = pictures_of<bench::FrameBenchRequest>(rays, renderer);
  request.repeats = options.repeats;
  request.fixed_views = options.what != "flight";
  request.flight_frames = options.flight_frames;
  request.upload_s = options.upload_ms / 1e3;
  return request;
}

int run(const RenderBenchOptions& options) {
  if (options.what == "flight" && options.flight_frames == 0)
    throw UsageError("--flight 0 with --what flight: expected at least one frame, else nothing is measured");
  const FrameRenderer::Options renderer = renderer_options(options.renderer);  // called once, because it queries the
                                                                               // driver for devices
  const bench::FirstHitBenchRequest request = request_of(options, renderer);
  nlohmann::ordered_json j{{"bench", "render"}, {"width", request.width}, {"height", request.height}};
  bool all_right = true;
  const auto tell = [&](const char* key, const auto& result) {
    all_right = all_right && !result.failed();
    j[key] = to_json(result);
    if (!options.json) print_text(result);
  };
  const auto timed = [](const char* name, const auto& work) {
    return while_reading([&](const Progress& progress) {
      progress.step(name);
      return work();
    });
  };
  const auto wants = [&](const char* what) { return options.what == what || options.what == "all"; };
  if (wants("first-hits")) {
    const auto result = timed("casting rays to the first voxel", [&] { return bench::bench_first_hits(request); });
    if (result.hits() == 0) print_message("gigabake: no ray of any view hit a voxel: nothing was compared\n");
    tell("first_hit", result);
  }
  if (wants("frames") || wants("flight")) {
    const auto result =
        timed("rendering frames", [&] { return bench::bench_frames(frames_of(options, request, renderer)); });
    if (result.surface_pixels() == 0) print_message("gigabake: no frame shows a voxel: nothing was measured\n");
    tell("frames", result);
  }
  if (wants("live")) {
    const auto result = timed(
        "running a viewer", [&] { return bench::bench_live(pictures_of<bench::LiveBenchRequest>(request, renderer)); });
    if (result.surface_pixels == 0) print_message("gigabake: the viewer shows no voxel: nothing was measured\n");
    tell("live", result);
  }
  if (options.json) fmt::print("{}\n", json_text(j));
  return all_right ? complete : failed;
}

}  // namespace

void add_bench_render(CLI::App& bench, int& exit_code) {
  auto* command = bench.get_subcommand("render");
  auto options = std::make_shared<RenderBenchOptions>();
  command->add_option("SCENE", options->scene, "folder of a bake, or its scene.xml")->required();
  command->add_option("--size", options->size, "WIDTHxHEIGHT in pixels; there are as many random rays")
      ->capture_default_str();
  command->add_option("--repeats", options->repeats, "runs per view; at most three on the CPU")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--what", options->what, "part to run; frames: fixed views and the flight")
      ->capture_default_str()
      ->check(one_of({"all", "first-hits", "frames", "flight", "live"}));
  command->add_option("--flight", options->flight_frames, "number of frames of the flight")
      ->capture_default_str()
      ->check(CLI::Range(0, 100000));
  command->add_option("--upload-ms", options->upload_ms, "milliseconds for uploads per frame")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6));
  add_renderer_options(*command, options->renderer);
  command->add_option("--lod", options->lod, "finest level to keep")->check(CLI::Range(0, 10));
  command->add_option("--reference-rays", options->reference_rays, "rays per view to check")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000000));
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options, &exit_code] {
    options->scene = scene_argument(options->scene).string();
    exit_code = run(*options);
  });
}

}  // namespace gigabake::app
