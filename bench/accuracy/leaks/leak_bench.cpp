#include "bench/accuracy/leaks/leak_bench.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "bench/accuracy/accuracy_views.h"
#include "bench/accuracy/leaks/leak_views.h"
#include "bench/bench_scene.h"
#include "format/system/publish.h"
#include "lattice/error.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/png.h"

namespace gigabake::bench {
namespace {

LeakViewRange range_of(const LeakBenchRequest& request) {
  LeakViewRange range;
  if (request.suite == LeakSuite::few_planes) {
    range.elevations_deg = {90, 35, 10};
    range.voxels_per_pixel = {4, 16};
  }
  range.width = request.width;
  range.height = request.height;
  return range;
}

BenchScene bench_scene_of(const LeakScene& scene, const std::filesystem::path& folder, int threads) {
  std::error_code error;
  std::filesystem::remove_all(folder, error);
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder, "", "cannot make the folder: " + error.message());
  BenchScene bench;
  bench.source = folder / "scene.glb";
  bench.source_options.local = true;
  bench.parameters.voxel_size_m = 1;
  bench.threads = threads;
  const std::vector<std::uint8_t> glb = sample::to_glb(scene.model);
  publish_file(bench.source, {reinterpret_cast<const char*>(glb.data()), glb.size()}, Durability::while_up);
  return bench;
}

AlphaPicture alpha_of(const LinearPicture& picture) {
  AlphaPicture out{picture.width, picture.height, {}};
  for (std::size_t i = 0; i < picture.pixels(); ++i) out.alpha.push_back(picture.alpha(i));
  return out;
}

/// "35-deg-16-anywhere.png"
std::string file_name(const LeakView& view) {
  std::string name = fmt::format("{:g}-deg-{:g}-{}.png", view.elevation_deg, view.voxels_per_pixel, name_of(view.eye));
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

/// One scene, from its files to its rows.
class LeakMeasurement {
 public:
  LeakMeasurement(const LeakScene& scene, const LeakBenchRequest& request, const std::optional<int>& device)
      : scene_(scene),
        request_(request),
        folder_(request.out / scene.name),
        bench_(bench_scene_of(scene, folder_, request.threads)),
        sources_(open_sources(bench_.source, bench_.source_options)) {
    if (scene.truth == LeakTruth::traced) caster_.emplace(sources_, bench_.parameters, request.threads);
    for (const CellReport& report : bake_scene(sources_, bench_, device, folder_)) voxels_ += report.cell.voxels.at(0);
  }

  std::uint64_t voxels() const { return voxels_; }

  std::vector<LeakRow> rows() const {
    FrameRenderer::Options options;
    options.threads = request_.threads;
    FrameRenderer renderer(folder_ / "scene.xml", options);
    std::vector<LeakRow> rows;
    for (const LeakView& view : leak_views(scene_, range_of(request_), bench_.parameters))
      rows.push_back({view.elevation_deg, view.voxels_per_pixel, view.eye, error_of(view, renderer)});
    if (!renderer.problems().empty()) throw InputError(folder_, "", renderer.problems().front());
    return rows;
  }

 private:
  LeakError error_of(const LeakView& view, FrameRenderer& renderer) const {
    const kernels::CastCamera camera = reference_camera(view.camera, bench_.parameters);
    const AlphaPicture inside = alpha_of_sheets(scene_, camera);
    const std::vector<bool> inner = inner_pixels(inside);
    if (std::none_of(inner.begin(), inner.end(), [](bool is_inner) { return is_inner; })) return {};
    const Picture picture = renderer.draw_exact({view.camera, ViewMode::albedo, {false, {0, 0, 0, 0}}}).picture;
    if (request_.keep) write_png(folder_ / file_name(view), picture);
    const AlphaPicture truth = caster_ ? alpha_of(caster_->draw(camera, request_.samples)) : inside;
    return leak_error(inner, truth, to_linear(picture));
  }

  const LeakScene& scene_;
  const LeakBenchRequest& request_;
  std::filesystem::path folder_;
  BenchScene bench_;
  SceneSources sources_;
  std::optional<ReferenceCaster> caster_;
  std::uint64_t voxels_ = 0;
};

LeakResult measure(const LeakScene& scene, const LeakBenchRequest& request, const std::optional<int>& device) {
  LeakResult result{scene.name, scene.family, scene.what, true, 0, {}, {}};
  result.is_opaque = scene.truth == LeakTruth::sheets && scene.sheet_alpha == 1;
  if (scene.truth == LeakTruth::traced && !ReferenceCaster::is_built()) {
    result.not_measured = "this gigabake was built without Embree, which traces its reference";
    return result;
  }
  const LeakMeasurement measurement(scene, request, device);
  result.voxels = measurement.voxels();
  result.rows = measurement.rows();
  if (result.rows.empty()) result.not_measured = "it is too small to be 24 pixels wide in any view";
  std::error_code ignored;
  if (!request.keep) std::filesystem::remove_all(request.out / scene.name, ignored);
  return result;
}

}  // namespace

bool LeakBench::is_bounded() const {
  for (const LeakResult& scene : scenes)
    for (const LeakRow& row : scene.rows)
      if (scene.is_opaque && !bench::is_bounded(row.error)) return false;
  return true;
}

std::vector<std::string> leak_families() {
  std::vector<std::string> families;
  for (const LeakScene& scene : leak_scenes(32))
    if (families.empty() || families.back() != scene.family) families.push_back(scene.family);
  return families;
}

LeakBench bench_leaks(const LeakBenchRequest& request, const LeakProgress& progress) {
  const std::optional<int> device = choose_device({request.backend}).device;
  LeakBench bench{device ? "cuda" : "cpu", request.edge, request.samples, {}};
  const std::vector<LeakScene> scenes =
      request.suite == LeakSuite::whole ? leak_scenes(request.edge) : few_leak_planes(request.edge);
  for (const LeakScene& scene : scenes) {
    if (!request.families.empty() && std::count(request.families.begin(), request.families.end(), scene.family) == 0)
      continue;
    progress(scene.name);
    bench.scenes.push_back(measure(scene, request, device));
  }
  return bench;
}

}  // namespace gigabake::bench
