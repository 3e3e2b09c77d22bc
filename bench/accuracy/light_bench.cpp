#include "bench/accuracy/light_bench.h"

#include <algorithm>

#include "bench/accuracy/accuracy_scene.h"
#include "core/base/error.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/image_files.h"

namespace gigabake::bench {
namespace {

constexpr int timed_frames = 3;  ///< images timed per view; the minimum time is recorded

View view_with(const AccuracyView& from, Shadows shadows) {
  View view{from.camera, ViewMode::lit, {false, {0, 0, 0, 0}}};
  view.shadows = shadows;
  return view;
}

Picture timed_picture(FrameRenderer& renderer, const View& view, double& seconds) {
  Picture picture = renderer.render_complete(view).picture;
  for (int i = 0; i < timed_frames; ++i) {
    const double frame_s = renderer.render_complete(view).stats.total_s;
    seconds = i == 0 ? frame_s : std::min(seconds, frame_s);
  }
  return picture;
}

void write_pictures(const std::filesystem::path& out, const AccuracyView& view, const LinearPicture& reference,
                    const Picture& picture) {
  std::string name = view.name();
  std::replace(name.begin(), name.end(), ' ', '-');
  write_png(out / (name + ".png"), picture);
  write_png(out / (name + "-reference.png"), to_srgb(reference));
}

/// Compares one view with its reference. The renderer `with` renders shadows, and `without` does not. Each renderer has
/// separate pools, which hold the data that its rays request.
LightRow look_at(const ReferenceCaster& caster, const AccuracyView& view, const AccuracyBenchRequest& request,
                 FrameRenderer& with, FrameRenderer& without) {
  const kernels::CastCamera camera = reference_camera(view.camera, request.scene.parameters);
  const kernels::CastLight light = afternoon_light();
  const LinearPicture reference = on_screen(caster.draw_shadowed(camera, request.samples, light, sun_radius_deg));
  const std::uint64_t pixels = compared_pixels(reference);
  expect_surface(request.scene.source, view.name(), pixels);
  const LinearPicture unshadowed = on_screen(caster.draw(camera, request.samples, light));
  LightRow row{view.name(), view.camera.width, view.camera.height, pixels};
  const Picture lit = timed_picture(with, view_with(view, Shadows::on), row.frame_s);
  const LinearPicture plain = to_linear(timed_picture(without, view_with(view, Shadows::off), row.frame_without_s));
  row.flip = picture_error(reference, to_linear(lit)).flip;
  row.flip_without = picture_error(reference, plain).flip;
  row.flip_unshadowed = picture_error(unshadowed, plain).flip;
  write_pictures(request.out, view, reference, lit);
  return row;
}

double mean(const std::vector<LightRow>& rows, double LightRow::*figure) {
  double sum = 0;
  for (const LightRow& row : rows) sum += row.*figure;
  return rows.empty() ? 0 : sum / double(rows.size());
}

}  // namespace

double LightBench::mean_flip() const { return mean(rows, &LightRow::flip); }
double LightBench::mean_flip_without() const { return mean(rows, &LightRow::flip_without); }
double LightBench::mean_flip_unshadowed() const { return mean(rows, &LightRow::flip_unshadowed); }
double LightBench::time_ratio() const {
  return mean(rows, &LightRow::frame_s) / mean(rows, &LightRow::frame_without_s);
}

LightBench bench_light(const AccuracyBenchRequest& request, const AccuracyProgress& progress) {
  LightBench bench{
      request.scene.source.string(), request.scene.parameters.voxel_size_m, request.samples, request.scene.threads, {}};
  const AccuracyScene scene(request, progress);
  FrameRenderer with(request.out / "scene.xml", scene.renderer), without(request.out / "scene.xml", scene.renderer);
  for (const AccuracyView& view :
       accuracy_views(scene.caster, request.scene.parameters, accuracy_scales, request.width, request.height)) {
    progress(view.name());
    bench.rows.push_back(look_at(scene.caster, view, request, with, without));
  }
  if (!with.problems().empty()) throw InputError(request.out, "", with.problems().front());
  return bench;
}

}  // namespace gigabake::bench
