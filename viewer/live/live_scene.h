/// A scene that several viewers see. One thread renders the requests of the viewers' schedulers in round-robin order. A
/// full-size image is rendered in time slices, so that other viewers get their turns. Rendering of an image is
/// cancelled when its viewer moves or leaves.
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "format/scene/scene_watch.h"
#include "format/system/file_stamp.h"
#include "viewer/live/cell_boxes.h"
#include "viewer/live/picked_point.h"
#include "viewer/live/render_scheduler.h"
#include "viewer/live/scene_editor.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// A frame of one viewer.
struct LiveFrame {
  std::uint64_t number = 0;  ///< counts this viewer's frames, from 1
  Frame frame;
  View view;         ///< the view that was rendered
  PictureRays rays;  ///< the rays of the image
  /// The image without the boxes of a running bake and previews of edits; null if `frame` has none.
  std::shared_ptr<const Picture> without_boxes = {};
  bool full = false;        ///< has full size; all pixels are final if frame.stats.complete
  double frames_per_s = 0;  ///< smoothed; 0 if the previous frame is a second or more older

  const Picture& clean_picture() const { return without_boxes ? *without_boxes : frame.picture; }
};

/// The state that a viewer is shown in addition to frames.
struct ViewerState {
  bool has_scene = false;
  bool is_watching = false;    ///< the scene is that of a running bake
  bool has_place = false;      ///< the scene has an origin on the earth, so a time can set the sun
  std::string problem;         ///< reason why the scene or the frame is missing; empty: no error
  std::uint64_t problems = 0;  ///< number of lines of FrameRenderer::problems() so far
  std::uint64_t uploads = 0;   ///< bricks and lists of children uploaded since the scene was opened, for all viewers
  CameraPose pose;
  CameraController::Style style = CameraController::Style::orbit;
  View full_view;
  double speed_m_per_s = 0, upload_s = 0;
  bool resting = false;  ///< the last frame is complete at full size, or has failed
  double drawn = 0;      ///< fraction of the current image that is final
};

/// Thread-safe: any thread may call any member.
class LiveScene {
 public:
  struct Options {
    FrameRenderer::Options renderer;
    CameraOptions camera;   ///< initial camera of every viewer
    double frame_s = 0.06;  ///< target time of a frame while the viewer moves
    std::size_t max_viewers = 16;
    /// Returns the initial view of a new viewer.
    /// Errors  UsageError: the message is shown in place of the scene.
    std::function<ViewerInput(const SceneHeader&)> look = [](const SceneHeader&) { return ViewerInput{}; };
    std::shared_ptr<SceneEditor> editor;    ///< edits the scene; null: viewers cannot edit
    std::shared_ptr<SceneWatch> watch;      ///< of the bake that writes the scene; null: shows published scenes only
    std::function<void()> changed = [] {};  ///< called by the rendering thread after each frame and each loaded scene
  };
  enum class ViewerId : std::uint64_t {};
  using FramePtr = std::shared_ptr<const LiveFrame>;

  /// Renders `scene_path` once it exists, and loads it again whenever it is replaced. A missing file is not an error.
  /// While options.watch has a scene, renders this scene instead, with the boxes of the cells that are not done.
  LiveScene(std::filesystem::path scene_path, Options options);
  ~LiveScene();
  LiveScene(const LiveScene&) = delete;
  LiveScene& operator=(const LiveScene&) = delete;

  /// Adds a viewer; returns nullopt if there are max_viewers already. `first` is applied once a scene is loaded.
  std::optional<ViewerId> add_viewer(const ViewerInput& first = {});
  void remove_viewer(ViewerId id);

  /// Applies user input. This member and the next three return false, nullopt or nullptr if no viewer has `id`.
  bool steer(ViewerId id, const ViewerInput& input);
  std::optional<ViewerState> state(ViewerId id) const;
  /// Waits for a frame whose number exceeds `after` and returns the latest frame; nullptr after timeout_s.
  FramePtr frame_after(ViewerId id, std::uint64_t after, double timeout_s) const;
  /// Returns the complete full-size image once the viewer rests; nullptr after timeout_s.
  FramePtr full_frame(ViewerId id, double timeout_s) const;

  /// Returns the facts of the cell that picked_cell() finds in the last frame. Returns nullopt if there is none, or no
  /// bake is watched.
  std::optional<CellFacts> facts_at(ViewerId id, double right, double down) const;

  /// Shows a preview of edits in the viewer's images; none if `edits` is empty. Replaces the viewer's last preview.
  /// Returns false if the viewer has no image yet, or may_edit() is false.
  /// Errors  UsageError or InputError: see SceneEditor::preview().
  bool preview(ViewerId id, const std::string& edits);
  /// Applies the edits to the scene and ends the viewer's preview; undoes the last edit if `edits` is empty. Waits for
  /// its end.
  /// Range   Options::editor is set.
  /// Errors  InputError: see SceneEditor::apply().
  void edit(ViewerId id, const std::string& edits);
  bool may_edit() const { return options_.editor != nullptr; }

  bool has_scene() const;
  /// Ends the rendering and all waits permanently.
  void stop();

 private:
  struct Viewer {
    ViewerId id;
    std::optional<RenderScheduler> scheduler;  ///< set once a scene is loaded
    ViewerInput settings;                      ///< input before a scene was loaded
    FramePtr frame;
    std::uint64_t frame_pose = 0;  ///< `pose` of the request that `frame` shows
    double drawn_s = -HUGE_VAL;    ///< time of the last frame
    double drawn_share = 0;
    std::string problem;
    EditPreviews previews;

    std::optional<ProgressiveFrame> in_tiles;  ///< used by the rendering thread only
    std::uint64_t in_tiles_pose = 0;           ///< `pose` of the request that in_tiles renders
  };

  void draw_all();
  void reload_if_replaced();
  bool follow_bake();
  void show_watched(const WatchedScene& watched);
  void update_watched(const WatchedScene& watched);
  void redraw_boxes();
  void exchange();
  bool replace_in_place();
  bool has_boxes(const Viewer& viewer) const;
  void add_boxes(const Viewer& viewer, LiveFrame& frame) const;
  void redraw_boxes(Viewer& viewer);
  void open(const std::function<std::unique_ptr<FrameRenderer>()>& make, std::vector<CellBox> boxes);
  void release_renderer();
  std::shared_ptr<Viewer> next_order(RenderScheduler::RenderRequest& order, double& next_call_s);
  void draw(const std::shared_ptr<Viewer>& viewer, const RenderScheduler::RenderRequest& order);
  std::optional<Frame> render_request(Viewer& viewer, const RenderScheduler::RenderRequest& order);
  std::optional<Frame> slice(Viewer& viewer, const RenderScheduler::RenderRequest& order);
  PictureRays rays_of(const CameraOptions& camera) const;
  void publish_frame(Viewer& viewer, const RenderScheduler::RenderRequest& order, Frame frame, const PictureRays& rays);
  std::shared_ptr<Viewer> find(ViewerId id) const;
  double now_s() const;
  void apply_home(Viewer& viewer);
  ViewerInput with_sun(ViewerInput input) const;
  FramePtr wait_for_frame(ViewerId id, double timeout_s, const std::function<bool(const Viewer&)>& good) const;

  const std::filesystem::path path_;
  const Options options_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();

  mutable std::mutex mutex_;  ///< guards the members up to rendered_viewer_
  mutable std::condition_variable wake_drawing_, wake_viewers_;
  std::vector<std::shared_ptr<Viewer>> viewers_;  ///< in order of their next turn
  std::optional<CameraOptions> home_;             ///< set if a scene is loaded
  ViewerInput look_;                              ///< initial view of new viewers, from options_.look
  std::optional<Geodetic> place_;                 ///< the scene's origin on the earth
  std::vector<CellBox> boxes_;                    ///< of the cells of the watched bake
  bool is_watching_ = false;                      ///< the scene is options_.watch's
  std::string problem_;
  std::uint64_t problems_ = 0, uploads_ = 0, ids_ = 0;
  bool stop_ = false;
  const Viewer* rendered_viewer_ = nullptr;  ///< viewer at rest for which an image is being rendered

  std::atomic<bool> cancel_ = false;     ///< true: the image in progress would be discarded, so stop rendering
  std::atomic<bool> is_edited_ = false;  ///< true: look for a replaced scene at once
  std::atomic<bool> yield_ = false;      ///< true: another viewer moves, so end the time slice

  // Members of the rendering thread.
  std::unique_ptr<FrameRenderer> renderer_;
  FileStamp stamp_;
  std::uint64_t watched_bake_ = 0;  ///< WatchedScene::bake that was opened; 0: none
  std::vector<std::uint32_t> changed_cells_;
  std::vector<std::uint32_t> exchanged_cells_;  ///< done cells of the watched bake that are not shown yet
  double checked_s_ = -HUGE_VAL;
  std::thread thread_;
};

}  // namespace gigabake
