#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <fmt/core.h>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/commands.h"
#include "app/text_values.h"
#include "format/error.h"
#include "viewer/camera.h"
#include "viewer/page_cache.h"
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
};

/// Whole numbers between single separators, and nothing else.
std::optional<std::vector<int>> integers(const std::string& text, char separator) {
  std::vector<int> out;
  const char *at = text.data(), *end = at + text.size();
  for (;; ++at) {
    int value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || next == at) return std::nullopt;
    out.push_back(value);
    at = next;
    if (at == end) return out;
    if (*at != separator) return std::nullopt;
  }
}

std::optional<Point<Scene>> point_option(const std::string& text, const char* option) {
  if (text.empty()) return std::nullopt;
  const std::array<double, 3> v = triple(option, "X,Y,Z as three finite numbers", text);
  return Point<Scene>{v[0], v[1], v[2]};
}

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
  const auto size = integers(a.size, 'x');
  if (!size || size->size() != 2) throw UsageError(fmt::format("--size: expected WIDTHxHEIGHT, got '{}'", a.size));
  camera.width = (*size)[0];
  camera.height = (*size)[1];
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

}  // namespace

void add_render(CLI::App& app, int&) {
  const auto a = std::make_shared<RenderArguments>();
  CLI::App& command = *app.add_subcommand("render", "One picture of a baked scene, straight from its shards");
  command.add_option("SCENE", a->scene, "scene.xml of a bake")->required();
  command.add_option("-o,--output", a->picture, "PNG file to write")->required();
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
  command.callback([a] { run(*a); });
}

}  // namespace gigabake::app
