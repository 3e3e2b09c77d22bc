/// The interactive render scheduler. It turns user input into render requests, each with a view, a size and time
/// limits.
#pragma once

#include <array>
#include <optional>

#include "viewer/live/camera_controller.h"
#include "viewer/live/frame_budget.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// User input from the events of a window or browser. Unset members change nothing.
struct ViewerInput {
  std::array<double, 2> turn{}, pan{};  ///< right and up, in image heights, as for CameraController
  double zoom = 0;                      ///< notches, as CameraController::zoom()
  bool home = false;
  std::optional<std::array<double, 3>> walk;   ///< movement by held keys: forward, right, up, each −1 to 1
  std::optional<std::array<double, 2>> swing;  ///< rotation by held keys: right and up, image heights per second
  std::optional<CameraPose> pose;
  std::optional<CameraController::Style> style;
  std::optional<ViewMode> mode;
  std::optional<double> pixel_error;
  std::optional<std::array<double, 2>> sun;  ///< azimuth and elevation, degrees
  std::optional<JulianDay> time;             ///< LiveScene converts it to `sun` if the scene has an origin
  std::optional<Shadows> shadows;
  std::optional<LevelBlend> level_blend;
  std::optional<double> upload_s;
  std::optional<std::array<int, 2>> size;  ///< width and height of the full-size image, pixels

  bool moves() const;
};

/// The render scheduler of one viewer. It decides which image is rendered next; the caller renders. During movement the
/// scheduler requests small previews. At rest it requests a small preview until that preview is complete, then larger
/// images up to full size in tiles. After the full-size image it requests nothing. Times are seconds of any monotonic
/// clock.
/// Range   Any input is clamped: size to 16 … 4096 per edge, pixel_error to 2^-16 … 2^16, upload_s to 0.1 ms … 1 s. The
///         sun's azimuth is clamped to ±360° and its elevation to ±90°.
class RenderScheduler {
 public:
  static constexpr double rest_s = 0.25;   ///< a viewer rests if this time has passed since its last movement
  static constexpr double max_hold_s = 1;  ///< held keys are released if no input confirms them for this time

  static constexpr double max_root_wait_s = 0.7;       ///< max. wait of the first image for coarse data of all cells
  static constexpr double max_preview_upload_s = 0.5;  ///< max. upload time of a preview at rest

  struct RenderRequest {
    View view;
    bool full = false;       ///< has full size
    bool in_tiles = false;   ///< rendered in tiles of final pixels, without a time limit; false: a preview
    bool moving = false;     ///< the viewer moves; the frame is shown even if a newer pose exists
    double share = 1;        ///< fraction of the full width and height
    double upload_s = 0;     ///< max. time that a preview uploads new data
    double roots_s = 0;      ///< max. time that a preview waits while cells have no data
    std::uint64_t pose = 0;  ///< requests with the same number show the same view
  };

  /// Takes the view of a scene: `home` has an eye and a target. `frame_s` is the target time of a frame during
  /// movement.
  RenderScheduler(const CameraOptions& home, double frame_s);

  void steer(const ViewerInput& input, double now_s);
  /// Replaces the scene, so that all images are rendered again. A pose that the viewer has changed is kept; otherwise
  /// the pose becomes `home`.
  void new_scene(const CameraOptions& home);

  /// Applies the held keys and returns the next image to render; nullopt if the last frame is final.
  std::optional<RenderRequest> next(double now_s);
  /// Returns the time at which to call next() again if there is no input; HUGE_VAL: never. Valid right after next()
  /// returned nullopt.
  double next_call_s() const;
  /// Records that a request, or a part of a request in tiles, was rendered.
  void drawn(const RenderRequest& order, const FrameStats& stats);
  /// Returns true if the view has changed since the last request, whose image would therefore be discarded.
  bool is_stale() const { return stale_; }
  /// Records that a request failed. The request is not repeated until the view changes.
  void failed();

  /// Returns true if the last request was complete at full size, or failed, and the view has not changed since.
  bool rests() const { return done_ && !stale_; }

  const CameraController& controller() const { return camera_controller_; }
  const View& full_view() const { return view_; }
  double upload_s() const { return upload_s_; }

 private:
  void set_home(const CameraOptions& home);
  CameraPose fitted_home() const;
  void apply_settings(const ViewerInput& s);
  void advance(double now_s);
  bool holds() const;
  double next_share(bool moving) const;

  CameraController camera_controller_;
  FrameBudget frame_budget_;
  View view_;  ///< full-size view; requests replace its eye and target by the pose of camera_controller_
  double upload_s_ = 0.02;
  std::array<double, 3> walk_{};
  std::array<double, 2> swing_{};
  double held_s_ = 0, advanced_s_ = 0, moved_s_ = -HUGE_VAL;
  bool at_home_ = true;
  CameraPose home_;
  double home_aspect_ = 1;  ///< aspect ratio (width/height) at which home_ shows the whole scene; 0: no requirement
  bool stale_ = true;       ///< the view has changed since the last request
  double done_share_ = 0;   ///< `share` of the largest complete image of this view
  bool done_ = false;       ///< the full-size image is complete, or has failed
  bool any_drawn_ = false;  ///< an image of this scene has been rendered
  std::uint64_t pose_ = 0;  ///< counts the different views
  double looked_s_ = 0;     ///< time of the first request of this view
  double next_call_s_ = 0;
};

}  // namespace gigabake
