#include "viewer/pictures/frame_renderer.h"

#include <utility>

#include "core/base/error.h"
#include "viewer/pictures/frame_renderer_state.h"

namespace gigabake {
namespace {

Point<Scene> to_scene_m(const SceneHeader& scene, const Vec3d& voxels) {
  const Vec3d m = scene.lattice_origin_m + voxels * scene.voxel_size_m;
  return {m[0], m[1], m[2]};
}

}  // namespace

FrameRenderer::FrameRenderer(const SceneDescription& scene, const std::filesystem::path& scene_path,
                             const PageSource& pages, const Options& options)
    : state_(std::make_unique<State>(std::make_shared<const PagedScene>(PagedScene::of_cells(scene_path, scene)), pages,
                                     options)) {}

FrameRenderer::FrameRenderer(const std::filesystem::path& scene_path, const Options& options)
    : state_(std::make_unique<State>(std::make_shared<const PagedScene>(scene_path), PageSource(), options)) {}

FrameRenderer::FrameRenderer(const std::filesystem::path& scene_path, const SceneDescription& watched,
                             const Options& options)
    : state_(std::make_unique<State>(std::make_shared<const PagedScene>(PagedScene::of_cells(scene_path, watched)),
                                     PageSource(), options)) {}

FrameRenderer::~FrameRenderer() = default;

const PagedScene& FrameRenderer::scene() const { return *state_->scene; }
const ThreadPool& FrameRenderer::pool() const { return state_->policy; }

kernels::CastCamera FrameRenderer::rays_of(const CameraOptions& options) const {
  return make_camera(options, *state_->scene);
}

CameraOptions FrameRenderer::framed(const CameraOptions& options) const {
  const kernels::CastCamera camera = rays_of(options);
  CameraOptions out = options;
  out.is_framed = !options.eye_m;
  out.eye_m = to_scene_m(state_->scene->header(), camera.eye);
  if (out.target_m) return out;
  const kernels::CastScene& scene = state_->stream->layout().scene;
  const double along = dot((scene.min + scene.max) / 2 - camera.eye, camera.forward);
  const Vec3d target = camera.eye + camera.forward * (along > 1 ? along : 1);
  out.target_m = to_scene_m(state_->scene->header(), target);
  return out;
}

Frame FrameRenderer::draw(const View& view, double upload_s) {
  state_->show(view);
  if (state_->starved) return render_complete(view);
  return state_->pass_over(view, {upload_s, 0, {}}, false);
}

Frame FrameRenderer::render_preview(const View& view, const PreviewLimits& limits) {
  state_->show(view);
  return state_->pass_over(view, limits, true);
}

Frame FrameRenderer::render_complete(const View& view, const Progress& progress) {
  ProgressiveFrame frame = begin(view, nullptr);
  frame.tiles = state_->tiles_of_whole(view.camera.width, view.camera.height);
  progress.step("rendering", frame.tiles.size());
  const auto tile_done = [&] {
    progress.advance();
    return false;
  };
  resume(frame, tile_done, {});
  return {std::move(frame.picture), frame.stats};
}

ProgressiveFrame FrameRenderer::begin(const View& view, const Picture* meanwhile) {
  check_picture_size(view.camera);
  state_->show(view);
  ProgressiveFrame frame;
  frame.view = view;
  const int width = view.camera.width, height = view.camera.height;
  frame.picture =
      meanwhile ? enlarged(*meanwhile, width, height, view.light) : blank_picture(width, height, view.light);
  frame.tiles = tiles_of(width, height, state_->stream->tile_edge());
  return frame;
}

void FrameRenderer::resume(ProgressiveFrame& frame, const kernels::StopAsked& enough, const kernels::StopAsked& stop) {
  State& s = *state_;
  const auto start = State::Clock::now();
  s.show(frame.view);
  s.requested.clear();
  const std::uint64_t uploads_before = s.stream->uploads();
  const kernels::CastCamera camera = s.camera_of(frame.view);
  const RenderSettings look = s.look_of(frame.view);
  PassCounts counts;
  while (!frame.is_complete()) {
    if (!render_tile(*s.stream, camera, frame.tiles[frame.done], look, stop, frame.picture, counts)) break;
    ++frame.done;
    if (enough && enough()) break;
  }
  frame.stats.total_s += State::since(start);
  frame.stats.cast_s = frame.stats.total_s;
  frame.stats.uploads += s.stream->uploads() - uploads_before;
  frame.stats.passes += counts.passes;
  frame.stats.page_waits += counts.page_waits;
  frame.stats.complete = frame.is_complete();
  s.tell(frame.stats);
}

void FrameRenderer::replace_shards(const std::vector<SceneCell>& watched, const std::vector<std::uint32_t>& cells) {
  State& s = *state_;
  if (!s.next) s.next = {s.scene, s.numbers, {}, s.edits};
  for (const std::uint32_t cell : cells) {
    s.next->numbers.cells.at(cell) = s.table->add(watched.at(cell));
    s.next->changed.push_back(window_of(watched[cell]));
  }
  s.stream->begin_exchange(*s.next->scene, s.next->numbers, s.next->changed);
}

bool FrameRenderer::replace_scene() {
  State& s = *state_;
  const auto next = std::make_shared<const PagedScene>(s.scene->file());
  if (!s.stream->problems().empty()) return false;  // opening the scene again tries unreadable pages again
  if ((!s.table && !s.paged_table) || !are_exchangeable(*s.scene, *next) || !s.stream->has_layout_of(*next))
    return false;
  std::string edits = edits_text_of(*next);
  const EditedBoxes edited(voxel_edits_in(*s.scene, s.edits), voxel_edits_in(*next, edits), next->header());
  std::optional<SceneChanges> changes = s.paged_table
                                            ? paged_changes_between(*s.scene, s.numbers, *next, edited, *s.paged_table)
                                            : changes_between(*s.scene, s.numbers, *next, edited, *s.table);
  if (!changes) return false;
  s.next = {next, std::move(changes->numbers), std::move(changes->boxes), std::move(edits)};
  s.stream->begin_exchange(*next, s.next->numbers, s.next->changed);
  return true;
}

bool FrameRenderer::has_exchange() const { return state_->next.has_value(); }

bool FrameRenderer::advance_exchange(double upload_s) {
  State& s = *state_;
  // The pools may have been refilled for another mode since the exchange began.
  const bool is_refilled = !s.stream->has_exchange();
  if (is_refilled && !s.stream->has_layout_of(*s.next->scene)) {
    s.adopt_next();
    s.stream.reset();
    s.fill(s.filling);
    return true;
  }
  if (is_refilled) s.stream->begin_exchange(*s.next->scene, s.next->numbers, s.next->changed);
  if (!s.stream->advance_exchange(State::after(upload_s))) return false;
  s.adopt_next();
  return true;
}

std::uint64_t FrameRenderer::uploads() const { return state_->stream->uploads(); }

std::uint64_t FrameRenderer::uploaded_bytes() const { return state_->stream->uploaded_bytes(); }

std::vector<std::string> FrameRenderer::problems() const {
  std::vector<std::string> all = state_->problems;
  for (std::string& problem : state_->stream->problems()) all.push_back(std::move(problem));
  return all;
}

}  // namespace gigabake
