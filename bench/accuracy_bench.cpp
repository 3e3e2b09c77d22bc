#include "bench/accuracy_bench.h"

#include <algorithm>
#include <limits>

#include "format/error.h"
#include "scheduler/merge.h"
#include "viewer/frame_renderer.h"
#include "viewer/png.h"

namespace gigabake::bench {
namespace {

constexpr std::size_t cells_in_flight = 4;

struct Surface {
  SurfaceRule rule;
  const char* name;
};
constexpr Surface surfaces[] = {
    {SurfaceRule::area, "area"}, {SurfaceRule::conservative, "conservative"}, {SurfaceRule::thin, "thin"}};

struct Mip {
  MipFilter filter;
  const char* name;
};
constexpr Mip mips[] = {{MipFilter::coverage, "coverage"}, {MipFilter::thesis, "thesis"}, {MipFilter::box, "box"}};

AccuracySetting make_setting(const BakeParameters& parameters, const Surface& surface, const Mip& mip, int coarser) {
  AccuracySetting setting;
  setting.surface = surface.name;
  setting.mip = mip.name;
  setting.name = setting.surface + "-" + setting.mip + (coarser > 1 ? "-x" + std::to_string(coarser) : "");
  setting.parameters = parameters;
  setting.parameters.surface = surface.rule;
  setting.parameters.mip = mip.filter;
  setting.parameters.voxel_size_m *= coarser;
  setting.parameters.normals = true;
  setting.parameters.max_error = 0;
  setting.parameters.codec = Codec::deflate;
  return setting;
}

std::vector<AccuracySetting> all_settings(const BakeParameters& parameters) {
  std::vector<AccuracySetting> settings;
  for (const int coarser : {1, 2}) {
    for (const Surface& surface : surfaces)
      for (const Mip& mip : mips) settings.push_back(make_setting(parameters, surface, mip, coarser));
    settings.push_back(make_setting(parameters, surfaces[0], mips[0], coarser));
    settings.back().name += "-no-normals";
    settings.back().parameters.normals = false;
  }
  for (const std::uint32_t codes : {1, 2, 4, 8, 16}) {
    settings.push_back(make_setting(parameters, surfaces[0], mips[0], 1));
    settings.back().name += "-error-" + std::to_string(codes);
    settings.back().parameters.max_error = codes;
  }
  settings.push_back(make_setting(parameters, surfaces[0], mips[0], 1));
  settings.back().name += "-lz4";
  settings.back().parameters.codec = Codec::lz4;
  return settings;
}

/// As `gigabake bake`, by one process. The fastest of the calls for one setting counts.
void bake(const SceneSources& sources, const AccuracyBenchRequest& request, const std::optional<int>& device,
          const std::filesystem::path& out, AccuracySetting& setting) {
  std::filesystem::remove_all(out / "shards");
  BenchScene scene = request.scene;
  scene.parameters = setting.parameters;
  const auto start = Clock::now();
  const BakePlan plan = plan_scene(sources, scene);
  CellPipeline pipeline(sources, scene.parameters, WorkerOptions{scene.threads, scene.memory_bytes, out, device});
  const std::vector<CellReport> reports = bake_cells(pipeline, plan.jobs, cells_in_flight);
  write_scene(out / "scene.xml", merge(plan, reports, sources.origin, scene.parameters));
  setting.bake_s = std::min(setting.bake_s, seconds_since(start));
  setting.bytes = setting.voxels = 0;
  for (const CellReport& report : reports) {
    setting.bytes += report.cell.bytes;
    for (const std::uint64_t voxels : report.cell.voxels) setting.voxels += voxels;
  }
  if (setting.voxels == 0) throw InputError(request.scene.source, "", "no voxel is occupied; choose smaller voxels");
}

std::filesystem::path picture_path(const std::filesystem::path& folder, const AccuracyView& view) {
  std::string file = view.name() + ".png";
  std::replace(file.begin(), file.end(), ' ', '-');
  return folder / file;
}

std::vector<LinearPicture> draw_references(const ReferenceCaster& caster, const AccuracyBenchRequest& request,
                                           const std::vector<AccuracyView>& views) {
  const std::filesystem::path folder = request.out / "reference";
  std::filesystem::create_directories(folder);
  std::vector<LinearPicture> references;
  for (const AccuracyView& view : views) {
    references.push_back(caster.draw(reference_camera(view, request.scene.parameters), request.samples));
    write_png(picture_path(folder, view), to_srgb(references.back()));
  }
  return references;
}

void compare(const std::filesystem::path& folder, const AccuracyBench& bench,
             const std::vector<LinearPicture>& references, int threads, AccuracySetting& setting) {
  FrameRenderer::Options options;
  options.threads = threads;
  FrameRenderer renderer(folder / "scene.xml", options);
  std::vector<PictureError> errors;
  for (std::size_t v = 0; v < bench.views.size(); ++v) {
    const View view{bench.views[v].camera, ViewMode::albedo, {false, {0, 0, 0, 0}}};
    const Frame frame = renderer.draw_exact(view);
    errors.push_back(picture_error(references[v], to_linear(frame.picture)));
    setting.views.push_back({bench.views[v].name(), frame.stats.total_s, errors.back()});
    setting.render_s += frame.stats.total_s;
    write_png(picture_path(folder, bench.views[v]), frame.picture);
  }
  if (!renderer.problems().empty()) throw InputError(folder, "", renderer.problems().front());
  setting.mean = mean_error(errors);
}

}  // namespace

AccuracyBench bench_accuracy(const AccuracyBenchRequest& request, const AccuracyProgress& progress) {
  const SceneSources sources = open_sources(request.scene.source, request.scene.source_options);
  const DeviceChoice device = choose_device({request.backend});
  AccuracyBench bench;
  bench.backend = device.device ? "cuda" : "cpu";
  bench.voxel_size_m = request.scene.parameters.voxel_size_m;
  bench.samples = request.samples;
  std::vector<LinearPicture> references;
  {
    progress("reference");
    const auto start = Clock::now();
    const ReferenceCaster caster(sources, request.scene.parameters, request.scene.threads);
    bench.views = accuracy_views(caster, request.scene.parameters, request.width, request.height);
    references = draw_references(caster, request, bench.views);
    bench.reference_s = seconds_since(start);
  }
  for (AccuracySetting& setting : all_settings(request.scene.parameters)) {
    progress(setting.name);
    const std::filesystem::path folder = request.out / setting.name;
    setting.bake_s = std::numeric_limits<double>::infinity();
    for (int i = 0; i < request.repeats; ++i) bake(sources, request, device.device, folder, setting);
    compare(folder, bench, references, request.scene.threads, setting);
    bench.settings.push_back(std::move(setting));
  }
  return bench;
}

}  // namespace gigabake::bench
