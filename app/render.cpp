#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/text_values.h"
#include "format/error.h"
#include "viewer/frame_renderer.h"
#include "viewer/png.h"

namespace gigabake::app {
namespace {

struct RenderArguments {
  std::string scene, picture;
  std::string eye, target, up, size = "1280x720", background = "sky", mode = "lit";
  double fovy_deg = 40, lod_bias = 0;
  int threads = 0;
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;
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

ViewMode mode_option(const std::string& text) {
  const std::vector<std::string>& names = view_mode_names();
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) return ViewMode(found - names.begin());
  throw UsageError(fmt::format("--mode: expected one of {}, got '{}'", fmt::join(names, ", "), text));
}

int run(const RenderArguments& a) {
  const View view{camera_options(a), mode_option(a.mode), background_option(a.background)};
  FrameRenderer::Options options;
  options.threads = a.threads;
  options.memory_bytes = a.memory_bytes != 0 ? a.memory_bytes : UINT64_MAX;
  FrameRenderer renderer(a.scene, options);
  const Frame frame = renderer.draw_exact(view);
  write_png(a.picture, frame.picture);
  fmt::print("{}: {}x{} in {:.2f} s; {} uploads, {:.0f} MB held\n", a.picture, frame.picture.width,
             frame.picture.height, frame.stats.total_s, frame.stats.uploads, double(frame.stats.bytes_held) / 1e6);
  for (const std::string& problem : renderer.problems()) fmt::print(stderr, "gigabake: drawn coarser: {}\n", problem);
  return renderer.problems().empty() ? complete : cells_failed;
}

}  // namespace

void add_render(CLI::App& app, int& exit_code) {
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
  command.add_option("--mode", a->mode, fmt::format("what is shown: {}", fmt::join(view_mode_names(), ", ")))
      ->capture_default_str();
  command.add_option("--lod-bias", a->lod_bias, "levels coarser than a pixel")->capture_default_str();
  command.add_option("--threads", a->threads, "CPU threads (all cores)");
  command.add_option("--memory", a->memory_bytes, "bytes of voxels to hold, as 512M or 4G; 0: half of the host's (1G)")
      ->transform(CLI::AsSizeValue(false));
  command.callback([a, &exit_code] { exit_code = run(*a); });
}

}  // namespace gigabake::app
