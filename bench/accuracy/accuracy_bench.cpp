#include "bench/accuracy/accuracy_bench.h"

#include <algorithm>
#include <limits>
#include <map>

#include "core/base/error.h"
#include "core/octree/octree.h"
#include "kernels/marching/cast_camera.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/image_files.h"

namespace gigabake::bench {
namespace {

AccuracySetting make_setting(const BakeParameters& parameters, SurfaceRule surface, MipFilter mip, int coarser) {
  AccuracySetting setting;
  setting.surface = name_of(surface);
  setting.mip = name_of(mip);
  setting.name = setting.surface + "-" + setting.mip + (coarser > 1 ? "-x" + std::to_string(coarser) : "");
  setting.parameters = parameters;
  setting.parameters.surface = surface;
  setting.parameters.mip = mip;
  setting.parameters.voxel_size_m *= coarser;
  setting.parameters.normals = setting.parameters.directional_coverage = true;
  setting.parameters.max_error = setting.parameters.depth_error = 0;
  setting.parameters.codec = Codec::deflate;
  return setting;
}

std::vector<AccuracySetting> all_settings(const BakeParameters& parameters) {
  std::vector<AccuracySetting> settings;
  for (const int coarser : {1, 2}) {
    for (const SurfaceRule surface : values_of<SurfaceRule>())
      for (const MipFilter mip : values_of<MipFilter>())
        settings.push_back(make_setting(parameters, surface, mip, coarser));
    settings.push_back(make_setting(parameters, SurfaceRule::area, MipFilter::coverage, coarser));
    settings.back().name += "-no-normals";
    settings.back().parameters.normals = false;
  }
  for (const std::uint32_t codes : {1, 2, 4, 8, 16}) {
    settings.push_back(make_setting(parameters, SurfaceRule::area, MipFilter::coverage, 1));
    settings.back().name += "-error-" + std::to_string(codes);
    settings.back().parameters.max_error = codes;
  }
  for (const std::uint32_t codes : {2, 4, 8, 16}) {
    settings.push_back(make_setting(parameters, SurfaceRule::area, MipFilter::coverage, 1));
    settings.back().name += "-depth-" + std::to_string(codes);
    settings.back().parameters.depth_error = codes;
    settings.back().parameters.coarsest_lod = max_ended_lod;
  }
  for (const bool normals : {true, false}) {
    settings.push_back(make_setting(parameters, SurfaceRule::area, MipFilter::coverage, 1));
    settings.back().name += normals ? "-no-facing" : "-rgba";
    settings.back().parameters.normals = normals;
    settings.back().parameters.directional_coverage = false;
  }
  settings.push_back(make_setting(parameters, SurfaceRule::area, MipFilter::coverage, 1));
  settings.back().name += "-lz4";
  settings.back().parameters.codec = Codec::lz4;
  return settings;
}

std::vector<AccuracySetting> chosen_settings(const AccuracyBenchRequest& request) {
  std::vector<AccuracySetting> all = all_settings(request.scene.parameters), chosen;
  if (request.only.empty()) return all;
  for (const std::string& name : request.only)
    if (std::none_of(all.begin(), all.end(), [&](const AccuracySetting& s) { return s.name == name; }))
      throw UsageError("--settings: no setting is called '" + name + "'");
  for (AccuracySetting& s : all)
    if (std::count(request.only.begin(), request.only.end(), s.name) != 0) chosen.push_back(std::move(s));
  return chosen;
}

/// Bakes one setting; keeps the minimum time of repeated calls.
void bake(const SceneSources& sources, const AccuracyBenchRequest& request, const std::optional<int>& device,
          const std::filesystem::path& out, AccuracySetting& setting) {
  std::filesystem::remove_all(out / "shards");
  BenchScene scene = request.scene;
  scene.parameters = setting.parameters;
  const auto start = Clock::now();
  const std::vector<CellReport> reports = bake_scene(sources, scene, device, out);
  setting.bake_s = std::min(setting.bake_s, seconds_since(start));
  setting.bytes = setting.voxels = 0;
  for (const CellReport& report : reports) {
    setting.bytes += report.cell.bytes;
    for (const std::uint64_t voxels : report.cell.voxels) setting.voxels += voxels;
  }
  if (setting.voxels == 0) throw InputError(request.scene.source, "", "no voxel is occupied; choose smaller voxels");
}

/// A cache of voxel errors, keyed by voxel size and content hash.
class KnownVoxelErrors {
 public:
  KnownVoxelErrors(const ReferenceCaster& caster, const AccuracyBenchRequest& request)
      : caster_(caster), request_(request) {}

  const VoxelError& of(const std::filesystem::path& scene, const AccuracySetting& setting) {
    Hash128 hash;
    for (const SceneCell& cell : read_scene(scene).cells) hash += cell.content_hash.at(0);
    const auto [known, is_new] = known_.try_emplace({setting.parameters.voxel_size_m, hash.hex()});
    if (is_new) {
      const double coarser = setting.parameters.voxel_size_m / request_.scene.parameters.voxel_size_m;
      known->second = voxel_error(caster_, scene, int(coarser + 0.5), request_.sample, request_.scene.threads);
    }
    return known->second;
  }

 private:
  const ReferenceCaster& caster_;
  const AccuracyBenchRequest& request_;
  std::map<std::pair<double, std::string>, VoxelError> known_;
};

std::filesystem::path picture_path(const std::filesystem::path& folder, const AccuracyView& view) {
  std::string file = view.name() + ".png";
  std::replace(file.begin(), file.end(), ' ', '-');
  return folder / file;
}

/// Applies tone mapping to an image of lit surface.
LinearPicture shown(LinearPicture picture, const kernels::CastTone& tone) {
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const float alpha = picture.alpha(i);
    for (std::size_t k = 0; k < 3 && alpha > 0; ++k)
      picture.rgba[4 * i + k] = alpha * kernels::shown_light(tone, picture.rgba[4 * i + k] / alpha);
  }
  return picture;
}

/// Returns true if voxels are larger than pixels. Their edges are then visible, most of all in lit images.
bool is_also_lit(const AccuracyView& view) { return view.voxels_per_pixel < 1; }

struct References {
  std::vector<LinearPicture> albedo, lit;  ///< `lit` has only the views with is_also_lit(), in the same order
};

References draw_references(const ReferenceCaster& caster, const AccuracyBenchRequest& request,
                           const std::vector<AccuracyView>& views) {
  const std::filesystem::path folder = request.out / "reference";
  std::filesystem::create_directories(folder);
  const kernels::CastTone tone = screen_tone(FrameRenderer::Options().exposure_stops);
  References references;
  for (const AccuracyView& view : views) {
    const kernels::CastCamera camera = reference_camera(view.camera, request.scene.parameters);
    references.albedo.push_back(caster.draw(camera, request.samples));
    expect_surface(request.scene.source, view.name(), compared_pixels(references.albedo.back()));
    write_png(picture_path(folder, view), to_srgb(references.albedo.back()));
    if (is_also_lit(view))
      references.lit.push_back(shown(caster.draw(camera, request.samples, afternoon_light()), tone));
  }
  return references;
}

Picture lit_picture(const std::filesystem::path& scene, const AccuracyView& view, int threads) {
  FrameRenderer::Options options;
  options.threads = threads;
  return FrameRenderer(scene, options).render_complete({view.camera, ViewMode::lit, {false, {0, 0, 0, 0}}}).picture;
}

void compare_lit(const std::filesystem::path& folder, const AccuracyBench& bench,
                 const std::vector<LinearPicture>& references, int threads, AccuracySetting& setting) {
  auto reference = references.begin();
  for (std::size_t v = 0; v < bench.views.size(); ++v)
    if (is_also_lit(bench.views[v])) {
      const LinearPicture lit = to_linear(lit_picture(folder / "scene.xml", bench.views[v], threads));
      setting.views[v].lit_flip = picture_error(*reference++, lit).flip;
    }
}

void compare(const std::filesystem::path& folder, const AccuracyBench& bench, const References& references, int threads,
             AccuracySetting& setting) {
  FrameRenderer::Options options;
  options.threads = threads;
  FrameRenderer renderer(folder / "scene.xml", options);
  std::vector<PictureError> errors;
  for (std::size_t v = 0; v < bench.views.size(); ++v) {
    const View view{bench.views[v].camera, ViewMode::albedo, {false, {0, 0, 0, 0}}};
    const Frame frame = renderer.render_complete(view);
    errors.push_back(picture_error(references.albedo[v], to_linear(frame.picture)));
    setting.views.push_back(
        {bench.views[v].name(), compared_pixels(references.albedo[v]), frame.stats.total_s, errors.back(), {}});
    setting.render_s += frame.stats.total_s;
    setting.bytes_held = std::max(setting.bytes_held, frame.stats.bytes_held);
    write_png(picture_path(folder, bench.views[v]), frame.picture);
  }
  if (!renderer.problems().empty()) throw InputError(folder, "", renderer.problems().front());
  setting.mean = mean_error(errors);
  compare_lit(folder, bench, references.lit, threads, setting);
}

}  // namespace

std::vector<std::string> accuracy_setting_names() {
  std::vector<std::string> names;
  for (const AccuracySetting& s : all_settings({})) names.push_back(s.name);
  return names;
}

AccuracyBench bench_accuracy(const AccuracyBenchRequest& request, const AccuracyProgress& progress) {
  std::vector<AccuracySetting> settings = chosen_settings(request);
  const SceneSources sources = open_sources(request.scene.source, request.scene.source_options, request.scene.progress);
  const DeviceChoice device = choose_device({request.backend});
  AccuracyBench bench;
  bench.backend = device.device ? "cuda" : "cpu";
  bench.voxel_size_m = request.scene.parameters.voxel_size_m;
  bench.samples = request.samples;
  progress("reference");
  const auto start = Clock::now();
  const ReferenceCaster caster(sources, request.scene.parameters, request.scene.threads);
  bench.views = accuracy_views(caster, request.scene.parameters, request.scales, request.width, request.height);
  const References references = draw_references(caster, request, bench.views);
  bench.reference_s = seconds_since(start);
  KnownVoxelErrors voxel_errors(caster, request);
  for (AccuracySetting& setting : settings) {
    progress(setting.name);
    const std::filesystem::path folder = request.out / setting.name;
    setting.bake_s = std::numeric_limits<double>::infinity();
    for (int i = 0; i < request.repeats; ++i) bake(sources, request, device.device, folder, setting);
    compare(folder, bench, references, request.scene.threads, setting);
    setting.voxel = voxel_errors.of(folder / "scene.xml", setting);
    bench.settings.push_back(std::move(setting));
  }
  return bench;
}

}  // namespace gigabake::bench
