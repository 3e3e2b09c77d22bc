#include "bench/accuracy/leaks/leak_bench.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "bench/accuracy/accuracy_views.h"
#include "bench/accuracy/leaks/leak_views.h"
#include "bench/accuracy/leaks/sheet_mesh.h"
#include "bench/bench_scene.h"
#include "core/base/error.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/image_files.h"

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

AlphaPicture alpha_of(const LinearPicture& picture) {
  AlphaPicture out{picture.width, picture.height, {}};
  for (std::size_t i = 0; i < picture.pixels(); ++i) out.alpha.push_back(picture.alpha(i));
  return out;
}

/// Returns a name like "35-deg-16-anywhere.png".
std::string file_name(const LeakView& view) {
  std::string name = fmt::format("{:g}-deg-{:g}-{}.png", view.elevation_deg, view.voxels_per_pixel, name_of(view.eye));
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

/// The image that determines a scene's inner pixels (inner_pixels()), and the true alpha.
struct LeakReference {
  AlphaPicture inside, reference_alpha;
};
using LeakReferenceOf = std::function<LeakReference(const kernels::CastCamera&)>;

/// Renders a baked scene from all views and compares each image with its reference.
std::vector<LeakRow> look(const std::filesystem::path& folder, const LeakSubject& subject, const BenchScene& bench,
                          const LeakBenchRequest& request, const LeakReferenceOf& reference_of) {
  FrameRenderer::Options options;
  options.threads = request.threads;
  FrameRenderer renderer(folder / "scene.xml", options);
  std::vector<LeakRow> rows;
  for (const LeakView& view : leak_views(subject, range_of(request), bench.parameters)) {
    rows.push_back({view.elevation_deg, view.voxels_per_pixel, view.eye, {}});
    const LeakReference reference = reference_of(reference_camera(view.camera, bench.parameters));
    const std::vector<bool> inner = inner_pixels(reference.inside);
    if (std::none_of(inner.begin(), inner.end(), [](bool is_inner) { return is_inner; })) continue;
    const Picture picture = renderer.render_complete({view.camera, ViewMode::albedo, {false, {0, 0, 0, 0}}}).picture;
    if (request.keep) write_png(folder / file_name(view), picture);
    rows.back().error = leak_error(inner, reference.reference_alpha, to_linear(picture));
  }
  if (!renderer.problems().empty()) throw InputError(folder, "", renderer.problems().front());
  return rows;
}

std::uint64_t bake_voxels(const SceneSources& sources, const BenchScene& bench, const std::optional<int>& device,
                          const std::filesystem::path& folder) {
  std::uint64_t voxels = 0;
  for (const CellReport& report : bake_scene(sources, bench, device, folder)) voxels += report.cell.voxels.at(0);
  return voxels;
}

void finish(LeakResult& result, const LeakBenchRequest& request, const std::filesystem::path& folder) {
  if (result.rows.empty()) result.not_measured = "it is too small to be 24 pixels wide in any view";
  std::error_code ignored;
  if (!request.keep) std::filesystem::remove_all(folder, ignored);
}

LeakResult measure(const LeakScene& scene, const LeakBenchRequest& request, const std::optional<int>& device) {
  LeakResult result{scene.name, scene.family, scene.what, true, 0, {}, {}, false};
  result.is_opaque = scene.reference_alpha == LeakReferenceKind::sheets && scene.sheet_alpha == 1;
  if (scene.reference_alpha == LeakReferenceKind::traced && !ReferenceCaster::is_built()) {
    result.not_measured = "this gigabake was built without Embree, which traces its reference";
    result.needs_embree = true;
    return result;
  }
  const std::filesystem::path folder = request.out / scene.name;
  const BenchScene bench = write_glb_scene(scene.model, folder, request.threads);
  const SceneSources sources = open_sources(bench.source, bench.source_options);
  std::optional<ReferenceCaster> caster;
  if (scene.reference_alpha == LeakReferenceKind::traced) caster.emplace(sources, bench.parameters, request.threads);
  result.voxels = bake_voxels(sources, bench, device, folder);
  result.rows = look(folder, subject_of(scene), bench, request, [&](const kernels::CastCamera& camera) {
    AlphaPicture inside = alpha_of_sheets(scene, camera);
    AlphaPicture reference_alpha = caster ? alpha_of(caster->draw(camera, request.samples)) : inside;
    return LeakReference{std::move(inside), std::move(reference_alpha)};
  });
  finish(result, request, folder);
  return result;
}

LeakBench begin(const LeakBenchRequest& request, const std::optional<int>& device, int edge) {
  return {device ? "cuda" : "cpu", edge, request.samples, {}};
}

/// Returns "village" for village.glb and for village/tileset.json.
std::string name_of(const BenchScene& scene) {
  const std::filesystem::path& source = scene.source;
  const bool is_tileset = source.has_parent_path() && source.stem() == "tileset";
  return is_tileset ? source.parent_path().filename().string() : source.stem().string();
}

/// Returns the subject of the user's scene. Its target is the highest point of the surface above or below the middle of
/// the box. If there is no such point, the target is a place in the middle of the surface's area.
LeakSubject subject_of(const ReferenceCaster& caster) {
  const TriangleBox& box = caster.box();
  LeakSubject subject;
  subject.target = box.centre();
  const Vec3d above{subject.target[0], subject.target[1], box.max[2] + 1};
  if (const auto depth = caster.first_hit(above, {0, 0, -1})) {
    subject.target[2] = above[2] - *depth;
  } else {
    const std::vector<Vec3d> places = visible_places(caster.triangles(), 3);
    subject.target = places[places.size() / 2];
  }
  subject.width = std::min(box.max[0] - box.min[0], box.max[1] - box.min[1]);
  const SourceTriangles& triangles = caster.triangles();
  for (std::size_t part = 0; part < triangles.parts(); ++part) {
    const std::vector<float> p = triangles.positions(part);
    for (std::size_t v = 0; v < p.size(); v += 3) subject.points.push_back(triangles.middle() + Vec3d::from(&p[v]));
  }
  return subject;
}

/// Returns the traced alpha. A pixel is inside if all its traced rays are opaque.
LeakReference traced_inside(const ReferenceCaster& caster, const kernels::CastCamera& camera, int samples) {
  LeakReference reference{alpha_of(caster.draw(camera, samples)), {}};
  reference.reference_alpha = reference.inside;
  for (double& alpha : reference.inside.alpha) alpha = alpha < 1 - 1e-5 ? 0 : 1;
  return reference;
}

}  // namespace

bool LeakBench::is_bounded() const {
  for (const LeakResult& scene : scenes)
    for (const LeakRow& row : scene.rows)
      if (scene.is_opaque && !bench::is_bounded(row.error)) return false;
  return true;
}

std::vector<std::string> LeakBench::unmeasured() const {
  std::vector<std::string> names;
  for (const LeakResult& scene : scenes) {
    std::size_t inner = 0;
    for (const LeakRow& row : scene.rows) inner += row.error.inner;
    if (inner < min_inner_pixels && !scene.needs_embree) names.push_back(scene.name);
  }
  return names;
}

std::vector<std::string> leak_families() {
  std::vector<std::string> families;
  for (const LeakScene& scene : leak_scenes(32))
    if (families.empty() || families.back() != scene.family) families.push_back(scene.family);
  return families;
}

LeakBench bench_leaks(const LeakBenchRequest& request, const LeakProgress& progress) {
  const std::optional<int> device = choose_device({request.backend}).device;
  LeakBench bench = begin(request, device, request.edge);
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

LeakBench bench_leaks_of(const BenchScene& scene, const LeakBenchRequest& request) {
  const std::optional<int> device = choose_device({request.backend}).device;
  LeakBench bench = begin(request, device, 0);
  const std::string name = name_of(scene);
  LeakResult result{name, "given", fmt::format("{:g} m a voxel", scene.parameters.voxel_size_m), true, 0, {},
                    {},   false};
  const SceneSources sources = open_sources(scene.source, scene.source_options);
  const ReferenceCaster caster(sources, scene.parameters, request.threads);
  const std::filesystem::path folder = request.out / name;
  result.voxels = bake_voxels(sources, scene, device, folder);
  result.rows = look(folder, subject_of(caster), scene, request,
                     [&](const kernels::CastCamera& camera) { return traced_inside(caster, camera, request.samples); });
  finish(result, request, folder);
  bench.scenes.push_back(std::move(result));
  return bench;
}

}  // namespace gigabake::bench
