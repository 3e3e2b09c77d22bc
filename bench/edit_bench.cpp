#include "bench/edit_bench.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>

#include "bench/bench_scene.h"
#include "core/base/error.h"
#include "viewer/live/edit_brush.h"
#include "viewer/live/live_scene.h"

namespace gigabake::bench {
namespace {

constexpr double max_wait_s = 600;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// A viewer of the scene, at rest in front of a surface.
class EditedView {
 public:
  explicit EditedView(const EditBenchRequest& request)
      : request_(request), scene_(request.scene, options_of(request)), viewer_(scene_.add_viewer().value()) {
    move_near(rest());
  }

  /// Returns the complete image at full size. The scene's folder is looked at every half second, so the viewer must
  /// have shown the latest edit before.
  LiveScene::FramePtr rest() { return arrived(scene_.full_frame(viewer_, max_wait_s)); }

  /// Returns the edit of a repeat. Brushes of repeats are one voxel apart, because a repeated edit finds its shard.
  std::string edits(std::size_t type, int repeat) const {
    EditBrush brush;
    Point<Scene> at_m = at_m_;
    at_m.x += repeat * voxel_size_m_;
    brush.type = type;
    brush.radius_m = request_.brush_voxels / 2 * voxel_size_m_;
    return edits_of(brush, at_m);
  }

  double preview_s(const std::string& edits) {
    const auto last = rest()->number;
    const auto start = Clock::now();
    scene_.preview(viewer_, edits);
    wait_for(last, [](const LiveFrame& frame) { return frame.without_boxes != nullptr; });
    return seconds_since(start);
  }

  /// Applies the edits, or an undo if they are empty, and sets its times and uploads.
  void edit(const std::string& edits, double& disk_s, double& image_s, double& rest_s, std::uint64_t& uploads) {
    const auto before = rest();
    const std::uint64_t uploaded = scene_.state(viewer_)->uploads;
    const auto start = Clock::now();
    scene_.edit(viewer_, edits);
    disk_s = seconds_since(start);
    wait_for(before->number, [&](const LiveFrame& frame) { return differs(frame, *before); });
    image_s = seconds_since(start);
    rest();
    rest_s = seconds_since(start);
    uploads = scene_.state(viewer_)->uploads - uploaded;
  }

  bool is_as_rendered() {
    const auto frame = rest();
    FrameRenderer renderer(request_.scene, request_.renderer);
    return renderer.render_complete(frame->view).picture.rgba == frame->clean_picture().rgba;
  }

 private:
  static LiveScene::Options options_of(const EditBenchRequest& request) {
    LiveScene::Options options;
    options.renderer = request.renderer;
    options.camera.width = request.width;
    options.camera.height = request.height;
    options.editor = request.editor;
    return options;
  }

  /// Moves the eye towards the surface in the image, and picks the point of this surface again.
  void move_near(const LiveScene::FramePtr& far) {
    const PickedPoint middle = picked(*far);
    voxel_size_m_ = far->rays.voxel_size_m;
    const auto& eye = far->view.camera.eye_m.value();
    const double nearer = request_.distance_voxels * voxel_size_m_ / middle.distance_m;
    ViewerInput input;
    const auto along = [&](double from, double to) { return to + (from - to) * nearer; };
    input.pose = CameraPose{{along(eye.x, middle.at_m.x), along(eye.y, middle.at_m.y), along(eye.z, middle.at_m.z)},
                            middle.at_m};
    scene_.steer(viewer_, input);
    const auto near = wait_for(far->number, [&](const LiveFrame& frame) {
      return frame.full && frame.frame.stats.complete && frame.view.camera.eye_m == input.pose->eye_m;
    });
    at_m_ = picked(*near).at_m;
  }

  /// Picks the surface in the pixel nearest to the middle, and remembers the pixel.
  PickedPoint picked(const LiveFrame& frame) {
    const Picture& picture = frame.clean_picture();
    const auto from_middle = [&](std::size_t pixel) {
      const auto width = std::size_t(picture.width);
      return std::hypot(double(pixel % width) - picture.width / 2, double(pixel / width) - picture.height / 2);
    };
    std::optional<std::size_t> nearest;
    for (std::size_t pixel = 0; pixel < picture.depth.size(); ++pixel)
      if (picture.depth[pixel] < kernels::CastRay::no_depth && (!nearest || from_middle(pixel) < from_middle(*nearest)))
        nearest = pixel;
    if (!nearest) throw InputError("edit", "", "the image shows no surface: nothing was measured");
    pixel_ = *nearest;
    const auto width = std::size_t(picture.width);
    return picked_point(picture, frame.rays, (double(pixel_ % width) + 0.5) / picture.width,
                        (double(pixel_ / width) + 0.5) / picture.height)
        .value();
  }

  static LiveScene::FramePtr arrived(LiveScene::FramePtr frame) {
    if (!frame) throw InputError("edit", "", "no image arrived within ten minutes");
    return frame;
  }

  LiveScene::FramePtr wait_for(std::uint64_t after, const std::function<bool(const LiveFrame&)>& good) {
    for (;;) {
      const auto frame = arrived(scene_.frame_after(viewer_, after, max_wait_s));
      if (good(*frame)) return frame;
      after = frame->number;
    }
  }

  /// Tests whether an image after the edit shows the edited scene. A viewer at rest renders smaller images only of
  /// another scene; an image without the preview has full size and the same pixels.
  bool differs(const LiveFrame& frame, const LiveFrame& before) const {
    const Picture &now = frame.clean_picture(), &then = before.clean_picture();
    if (now.width != then.width || now.height != then.height) return true;
    const auto rgba = [&](const Picture& picture) { return picture.rgba.begin() + std::ptrdiff_t(4 * pixel_); };
    return now.depth[pixel_] != then.depth[pixel_] || !std::equal(rgba(now), rgba(now) + 4, rgba(then));
  }

  const EditBenchRequest& request_;
  LiveScene scene_;
  LiveScene::ViewerId viewer_;
  Point<Scene> at_m_{};
  std::size_t pixel_ = 0;  ///< shows at_m_
  double voxel_size_m_ = 1;
};

EditBenchRow measure(EditedView& view, std::size_t type, int repeats, bool& is_as_rendered) {
  std::vector<double> preview, disk, image, rest, undo;
  EditBenchRow row;
  row.type = brush_types.at(type);
  for (int i = 0; i < repeats; ++i) {
    const std::string edits = view.edits(type, i);
    double disk_s = 0, image_s = 0, rest_s = 0;
    preview.push_back(view.preview_s(edits));
    view.edit(edits, disk_s, image_s, rest_s, row.uploads);
    disk.push_back(disk_s);
    image.push_back(image_s);
    rest.push_back(rest_s);
    is_as_rendered = is_as_rendered && view.is_as_rendered();
    std::uint64_t uploads = 0;
    view.edit({}, disk_s, image_s, rest_s, uploads);
    undo.push_back(disk_s);
  }
  row.preview_s = median(preview);
  row.disk_s = median(disk);
  row.image_s = median(image);
  row.rest_s = median(rest);
  row.undo_s = median(undo);
  return row;
}

}  // namespace

EditBench bench_edits(const EditBenchRequest& request) {
  EditBench out;
  out.width = request.width;
  out.height = request.height;
  out.brush_voxels = request.brush_voxels;
  EditedView view(request);
  const auto first = view.rest();
  for (const std::size_t type : {2, 0, 1})
    out.rows.push_back(measure(view, type, request.repeats, out.same_as_rendered));
  out.is_restored = view.rest()->clean_picture().rgba == first->clean_picture().rgba;
  return out;
}

}  // namespace gigabake::bench
