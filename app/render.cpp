#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "app/commands.h"
#include "app/text_values.h"
#include "format/error.h"
#include "format/publish.h"
#include "viewer/camera.h"
#include "viewer/camera_path.h"
#include "viewer/page_cache.h"
#include "viewer/path_frames.h"
#include "viewer/picture.h"
#include "viewer/png.h"

namespace gigabake::app {
namespace {

struct RenderArguments {
  std::string scene, picture;
  std::string eye, target, up, size = "1280x720", background = "sky";
  double fovy_deg = 40, lod_bias = 0;
  int threads = 0;
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;
  bool albedo = false;
  std::string path, stats, mode;
  int frames = 0;
  double fps = 0, upload_ms = 20;
  bool live = false;
};

Background background_option(const std::string& text) {
  if (text == "sky") return {};
  const auto v = integers(text, ',');
  const bool good = v && (v->size() == 3 || v->size() == 4);
  if (good) {
    Background background{false, {0, 0, 0, 255}};
    bool in_range = true;
    for (std::size_t k = 0; k < v->size(); ++k) {
      in_range = in_range && (*v)[k] >= 0 && (*v)[k] <= 255;
      background.rgba[k] = std::uint8_t((*v)[k]);
    }
    if (in_range) return background;
  }
  throw UsageError(fmt::format("--background: expected sky, R,G,B or R,G,B,A with 0 to 255 each, got '{}'", text));
}

CameraOptions camera_options(const RenderArguments& a) {
  CameraOptions camera;
  camera.eye_m = point_option(a.eye, "--eye");
  camera.target_m = point_option(a.target, "--target");
  camera.up = point_option(a.up, "--up");
  std::tie(camera.width, camera.height) = size_option(a.size);
  camera.fovy_deg = a.fovy_deg;
  camera.lod_bias = a.lod_bias;
  return camera;
}

void run(const RenderArguments& a) {
  const auto start = std::chrono::steady_clock::now();
  const CameraOptions camera_wanted = camera_options(a);
  const Background background = background_option(a.background);
  PageCache::Options options{a.albedo ? kernels::unlit() : afternoon_light(),
                             a.memory_bytes != 0 ? a.memory_bytes : UINT64_MAX};
  if (a.threads < 0 || a.threads > 1024) throw UsageError("--threads: expected 1 to 1024, or 0 for all cores");

  const SceneDescription scene = read_scene(a.scene);
  const kernels::CpuPolicy policy(a.threads > 0 ? a.threads : int(std::thread::hardware_concurrency()));
  const CellReader reader = read_from_shards(a.scene, scene);
  PageCache pages(scene, a.scene, reader, options, policy);
  kernels::CastCamera camera = make_camera(camera_wanted, scene, reader);
  if (background.sky && !a.albedo) camera.haze = air(pages.scene());
  write_png(a.picture, render(pages, camera, background, policy));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}: {}x{} in {:.2f} s; {} pages read, {:.0f} MB held\n", a.picture, camera.width, camera.height, seconds,
             pages.counts().loads, double(pages.counts().peak_bytes) / 1e6);
}

std::vector<double> frame_times(const RenderArguments& a, const CameraPath& path) {
  if ((a.frames != 0) == (a.fps != 0)) throw UsageError("--path: expected either --frames or --fps beside it");
  return a.frames != 0 ? times_of_frames(path, a.frames) : times_at_rate(path, a.fps);
}

ViewMode mode_option(const RenderArguments& a) {
  if (a.mode.empty()) return a.albedo ? ViewMode::albedo : ViewMode::lit;
  const std::vector<std::string>& names = view_mode_names();
  const auto found = std::find(names.begin(), names.end(), a.mode);
  if (found == names.end() || a.albedo)
    throw UsageError(fmt::format("--mode: expected one of {}, and no --albedo beside it", fmt::join(names, ", ")));
  return ViewMode(found - names.begin());
}

void run_path(const RenderArguments& a) {
  if (!(a.upload_ms > 0 && a.upload_ms <= 60000)) throw UsageError("--upload-ms: expected 0 to 60000 milliseconds");
  const View view{camera_options(a), mode_option(a), background_option(a.background)};
  numbered_file(a.picture, 0);
  FrameRenderer renderer(a.scene, {a.threads, a.memory_bytes != 0 ? a.memory_bytes : UINT64_MAX});
  const CameraPath path = read_camera_path(a.path, renderer.scene().origin);
  std::vector<PathFrame> frames;
  draw_path(renderer, path, view, frame_times(a, path), a.live ? Finish::live : Finish::complete, a.upload_ms / 1e3,
            [&](const PathFrame& frame, const Picture& picture) {
              write_png(numbered_file(a.picture, frame.number), picture);
              frames.push_back(frame);
            });
  if (!a.stats.empty()) publish_file(a.stats, to_json(frames));
  std::size_t incomplete = 0;
  for (const PathFrame& frame : frames) incomplete += !frame.stats.complete;
  fmt::print("{} frames{}\n", frames.size(), incomplete > 0 ? fmt::format(", {} of them incomplete", incomplete) : "");
  for (const std::string& problem : renderer.problems()) fmt::print(stderr, "gigabake: {}\n", problem);
}

/// Options that mean something along a path only.
void check_alone(const RenderArguments& a) {
  if (a.frames != 0 || a.fps != 0 || a.live || !a.stats.empty() || !a.mode.empty())
    throw UsageError("--frames, --fps, --live, --stats and --mode: expected a --path beside them");
}

}  // namespace

void add_render(CLI::App& app, int&) {
  const auto a = std::make_shared<RenderArguments>();
  CLI::App& command = *app.add_subcommand("render", "Pictures of a baked scene: one, or many along a path");
  command.add_option("SCENE", a->scene, "scene.xml of a bake")->required();
  command.add_option("-o,--output", a->picture, "PNG file to write; along a path frames/%04d.png or alike")->required();
  command.add_option("--eye", a->eye, "X,Y,Z: camera, scene metres (south-east of the target, all in view)");
  command.add_option("--target", a->target, "X,Y,Z: what the camera looks at (the middle of the scene)");
  command.add_option("--up", a->up, "X,Y,Z: direction that is up in the picture (0,0,1)");
  command.add_option("--fovy", a->fovy_deg, "vertical field of view, degrees")->capture_default_str();
  command.add_option("--size", a->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command.add_option("--background", a->background, "sky, or R,G,B[,A]: sRGB, 0 to 255 each")->capture_default_str();
  command.add_flag("--albedo", a->albedo, "the surface's own colour, without light and air");
  command.add_option("--lod-bias", a->lod_bias, "levels coarser than a pixel")->capture_default_str();
  command.add_option("--threads", a->threads, "CPU threads (all cores)");
  command.add_option("--memory", a->memory_bytes, "bytes of voxels to hold, as 512M or 4G; 0: no bound (1G)")
      ->transform(CLI::AsSizeValue(false));
  command.add_option("--path", a->path, "camera path, JSON (docs/viewer.md); instead of --eye and --target");
  command.add_option("--frames", a->frames, "so many, evenly along the path");
  command.add_option("--fps", a->fps, "so many for each second of the path");
  command.add_option("--mode", a->mode, fmt::format("{} (lit)", fmt::join(view_mode_names(), ", ")));
  command.add_option("--stats", a->stats, "JSON file to write: what each frame of the path took");
  command.add_flag("--live", a->live, "each frame once, complete or not, as somebody passing sees it");
  command.add_option("--upload-ms", a->upload_ms, "time for new data in each frame of --live")->capture_default_str();
  command.callback([a] {
    if (!a->path.empty()) return run_path(*a);
    check_alone(*a);
    run(*a);
  });
}

}  // namespace gigabake::app
