/// One scene that several viewers look at: a thread draws what each one's Pilot asks for, in turns. A full picture is
/// drawn in slices: others have their turns in between, and it ends at once when its own viewer moves or leaves.
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

#include "format/system/file_stamp.h"
#include "viewer/live/picked_point.h"
#include "viewer/live/pilot.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// A frame as one viewer sees it.
struct LiveFrame {
  std::uint64_t number = 0;  ///< of this viewer, from 1
  Frame frame;
  View view;                ///< as it was drawn
  PictureRays rays;         ///< as it was drawn
  bool full = false;        ///< of full size; all of it is final where frame.stats.complete
  double frames_per_s = 0;  ///< of the last ones; 0 where a second or more lies between
};

/// What a viewer is told beside frames.
struct ViewerState {
  bool has_scene = false;
  bool has_place = false;      ///< on the earth: the sun may follow a time
  std::string problem;         ///< why there is no scene or no frame; empty: all is well
  std::uint64_t problems = 0;  ///< shards that are missing or damaged, so far
  CameraPose pose;
  CameraRig::Style style = CameraRig::Style::orbit;
  View full_view;
  double speed_m_per_s = 0, upload_s = 0;
  bool resting = false;  ///< the last frame is all there is to see
  double drawn = 0;      ///< share of the picture under way that is final
};

/// All members may be called from any thread.
class LiveScene {
 public:
  struct Options {
    FrameRenderer::Options renderer;
    CameraOptions camera;   ///< of every viewer at first
    double frame_s = 0.06;  ///< that a frame of a moving viewer should take
    std::size_t most_viewers = 16;
    /// How a viewer that comes sees the scene at first. Errors  UsageError: what is said instead of showing it.
    std::function<Steering(const SceneHeader&)> look = [](const SceneHeader&) { return Steering{}; };
    std::function<void()> changed = [] {};  ///< after each frame and each scene; called by the thread that draws
  };
  enum class ViewerId : std::uint64_t {};
  using FramePtr = std::shared_ptr<const LiveFrame>;

  /// Draws `scene_path` from when it is there, and anew whenever it is replaced. No error where it is not.
  LiveScene(std::filesystem::path scene_path, Options options);
  ~LiveScene();
  LiveScene(const LiveScene&) = delete;
  LiveScene& operator=(const LiveScene&) = delete;

  /// first: its steering as soon as there is a scene. Nothing where most_viewers look already.
  std::optional<ViewerId> add_viewer(const Steering& first = {});
  void remove_viewer(ViewerId id);

  /// All of these: nothing, or false, where there is no such viewer.
  bool steer(ViewerId id, const Steering& steering);
  std::optional<ViewerState> state(ViewerId id) const;
  /// The last frame, as soon as its number is above `after`; nullptr after timeout_s.
  FramePtr frame_after(ViewerId id, std::uint64_t after, double timeout_s) const;
  /// The complete picture at full size of where the viewer rests; nullptr after timeout_s.
  FramePtr full_frame(ViewerId id, double timeout_s) const;

  bool has_scene() const;
  /// Lets every wait end at once and for good.
  void stop();

 private:
  struct Viewer {
    ViewerId id;
    std::optional<Pilot> pilot;  ///< since there is a scene
    Steering settings;           ///< asked for before that
    FramePtr frame;
    std::uint64_t frame_pose = 0;  ///< of the order that it answers
    double drawn_s = -HUGE_VAL;    ///< when the frame was
    double drawn_share = 0;
    std::string problem;

    std::optional<FrameInTiles> in_tiles;  ///< the drawing thread's own, as is
    std::uint64_t in_tiles_pose = 0;       ///< of the order that it is for
  };

  void draw_all();
  void reload_if_replaced();
  void reload();
  void release_renderer();
  std::shared_ptr<Viewer> next_order(Pilot::Order& order, double& ask_again_s);
  void draw(const std::shared_ptr<Viewer>& viewer, const Pilot::Order& order);
  std::optional<Frame> carry_out(Viewer& viewer, const Pilot::Order& order);
  std::optional<Frame> slice(Viewer& viewer, const Pilot::Order& order);
  PictureRays rays_of(const CameraOptions& camera) const;
  void hand_over(Viewer& viewer, const Pilot::Order& order, Frame frame, const PictureRays& rays);
  std::shared_ptr<Viewer> find(ViewerId id) const;
  double now_s() const;
  void show_home(Viewer& viewer);
  Steering with_sun(Steering steering) const;
  FramePtr wait_for_frame(ViewerId id, double timeout_s, const std::function<bool(const Viewer&)>& good) const;

  const std::filesystem::path path_;
  const Options options_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();

  mutable std::mutex mutex_;  ///< guards what follows
  mutable std::condition_variable wake_drawing_, wake_viewers_;
  std::vector<std::shared_ptr<Viewer>> viewers_;  ///< the next one to draw for comes first
  std::optional<CameraOptions> home_;             ///< where there is a scene
  Steering look_;                                 ///< of viewers that come, as of options_.look
  std::optional<Geodetic> place_;                 ///< of the scene on the earth
  std::string problem_;
  std::uint64_t problems_ = 0, ids_ = 0;
  bool stop_ = false;
  const Viewer* for_whom_ = nullptr;  ///< somebody who rests and is being drawn for

  std::atomic<bool> end_now_ = false;   ///< what is being drawn would be thrown away
  std::atomic<bool> end_soon_ = false;  ///< somebody else moves, and waits for a turn

  // The drawing thread's own.
  std::unique_ptr<FrameRenderer> renderer_;
  FileStamp stamp_;
  double looked_s_ = -HUGE_VAL;
  std::thread thread_;
};

}  // namespace gigabake
