#include "viewer/frame_renderer.h"

#include <array>
#include <chrono>
#include <optional>
#include <thread>

#include "format/error.h"
#include "viewer/page_cache.h"

namespace gigabake {
namespace {

Point<Scene> to_scene_m(const SceneDescription& scene, const double voxels[3]) {
  std::array<double, 3> m;
  for (std::size_t a = 0; a < 3; ++a) m[a] = scene.lattice_origin_m[a] + voxels[a] * scene.voxel_size_m;
  return {m[0], m[1], m[2]};
}

double since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

const std::vector<std::string>& view_mode_names() {
  static const std::vector<std::string> names{"lit", "albedo"};
  return names;
}

struct FrameRenderer::State {
  std::filesystem::path path;
  Options options;
  SceneDescription scene;
  kernels::CpuPolicy policy;
  CellReader reader;
  std::array<std::optional<PageCache>, 2> pages;  ///< by mode

  State(const std::filesystem::path& scene_path, const Options& wanted)
      : path(scene_path),
        options(wanted),
        scene(read_scene(scene_path)),
        policy(wanted.threads > 0 ? wanted.threads : int(std::thread::hardware_concurrency())),
        reader(read_from_shards(scene_path, scene)) {}

  PageCache& pages_of(ViewMode mode) {
    std::optional<PageCache>& found = pages[std::size_t(mode)];
    if (!found) {
      const kernels::CastLight light = mode == ViewMode::lit ? afternoon_light() : kernels::unlit();
      found.emplace(scene, path, reader, PageCache::Options{light, options.memory_bytes}, policy);
    }
    return *found;
  }
};

FrameRenderer::FrameRenderer(const std::filesystem::path& scene_path, const Options& options) {
  if (options.threads < 0 || options.threads > 1024)
    throw UsageError("--threads: expected 1 to 1024, or 0 for all cores");
  state_ = std::make_unique<State>(scene_path, options);
}

FrameRenderer::~FrameRenderer() = default;

const SceneDescription& FrameRenderer::scene() const { return state_->scene; }

CameraOptions FrameRenderer::framed(const CameraOptions& options) const {
  const kernels::CastCamera camera = make_camera(options, state_->scene, state_->reader);
  CameraOptions out = options;
  out.eye_m = to_scene_m(state_->scene, camera.eye);
  if (!out.target_m) {
    const PageCache& pages = state_->pages_of(ViewMode::lit);
    double along = 0, target[3];
    for (int a = 0; a < 3; ++a)
      along += ((pages.scene().min[a] + pages.scene().max[a]) / 2 - camera.eye[a]) * camera.forward[a];
    for (int a = 0; a < 3; ++a) target[a] = camera.eye[a] + camera.forward[a] * (along > 1 ? along : 1);
    out.target_m = to_scene_m(state_->scene, target);
  }
  return out;
}

Frame FrameRenderer::draw(const View& view, double) {
  const auto start = std::chrono::steady_clock::now();
  PageCache& pages = state_->pages_of(view.mode);
  kernels::CastCamera camera = make_camera(view.camera, state_->scene, state_->reader);
  if (view.background.sky && view.mode == ViewMode::lit) camera.haze = air(pages.scene());
  Frame frame;
  const std::uint64_t loads_before = pages.counts().loads;
  frame.picture = render(pages, camera, view.background, state_->policy);
  frame.stats.total_s = frame.stats.cast_s = since(start);
  frame.stats.uploads = pages.counts().loads - loads_before;
  frame.stats.bytes_held = pages.counts().peak_bytes;
  frame.stats.bytes_allowed = state_->options.memory_bytes;
  frame.stats.complete = true;
  return frame;
}

std::vector<std::string> FrameRenderer::problems() const { return {}; }

}  // namespace gigabake
