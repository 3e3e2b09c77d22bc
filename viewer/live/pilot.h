/// What a viewer's hands ask for, and what is to be drawn for it: when, where from and how large.
#pragma once

#include <array>
#include <optional>

#include "viewer/live/camera_rig.h"
#include "viewer/live/frame_pace.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// From a window's or a browser's events. Members left alone change nothing.
struct Steering {
  std::array<double, 2> turn{}, pan{};  ///< right and up, in picture heights, as CameraRig has them
  double zoom = 0;                      ///< notches, as CameraRig::zoom()
  bool home = false;
  std::optional<std::array<double, 3>> walk;   ///< keys held from now on: forward, right, up, each −1 to 1
  std::optional<std::array<double, 2>> swing;  ///< keys held from now on: turns right and up, heights a second
  std::optional<CameraPose> pose;
  std::optional<CameraRig::Style> style;
  std::optional<ViewMode> mode;
  std::optional<double> pixel_error;
  std::optional<std::array<double, 2>> sun;  ///< azimuth and elevation, degrees
  std::optional<JulianDay> time;             ///< instead, where the scene has a place: LiveScene makes a sun of it
  std::optional<Shadows> shadows;
  std::optional<LevelBlend> level_blend;
  std::optional<double> upload_s;
  std::optional<std::array<int, 2>> size;  ///< of the full picture

  bool moves() const;
};

/// A value that decides; others draw. Small sketches while it moves; where it rests a small one until it is complete,
/// then larger ones, the last one of full size, tile by tile; and nothing once that is done. Times are any clock's
/// seconds that never run back.
/// Range   Whatever is steered: size within 16 and 4096 a side, pixel_error within 2^±16, upload_s within 0.1 ms and
///         1 s, an azimuth of the sun within ±360° and an elevation within ±90°.
class Pilot {
 public:
  static constexpr double rest_s = 0.25;       ///< after the last movement
  static constexpr double longest_hold_s = 1;  ///< held keys that nobody confirms are let go

  static constexpr double first_roots_s = 0.7;     ///< that the first picture waits for something to stand everywhere
  static constexpr double longest_upload_s = 0.5;  ///< in one sketch, however long it rests

  struct Order {
    View view;
    bool full = false;       ///< of full size
    bool in_tiles = false;   ///< each pixel final as it comes, however long that takes; else a sketch
    bool moving = false;     ///< comes soon and is worth showing even if there is a newer pose by then
    double share = 1;        ///< of the full width and height
    double upload_s = 0;     ///< of a sketch: for new data
    double roots_s = 0;      ///< of a sketch: to wait while cells have nothing to show
    std::uint64_t pose = 0;  ///< orders of equal number show the same
  };

  /// home: with eye and target. frame_s: what a frame should take while moving.
  Pilot(const CameraOptions& home, double frame_s);

  void steer(const Steering& steering, double now_s);
  /// The scene is another one: everything is drawn again. The pose stays where the viewer has moved, else it is home.
  void new_scene(const CameraOptions& home);

  /// What to draw now; nothing where the last frame says it all. Moves on by the keys held.
  std::optional<Order> next(double now_s);
  /// Asked right after next() said nothing: when to ask again if nobody steers; HUGE_VAL: never.
  double ask_again_s() const;
  /// An order was carried out, or a part of one in tiles.
  void drawn(const Order& order, const FrameStats& stats);
  /// Something has changed since the last order: what is drawn for it would be thrown away.
  bool is_stale() const { return stale_; }
  /// An order could not be: it is not tried again before something changes.
  void failed();

  /// The last order was full and complete, or failed, and nothing has changed since.
  bool rests() const { return done_ && !stale_; }

  const CameraRig& rig() const { return rig_; }
  const View& full_view() const { return view_; }
  double upload_s() const { return upload_s_; }

 private:
  void set_home(const CameraOptions& home);
  CameraPose fitted_home() const;
  void apply_settings(const Steering& s);
  void advance(double now_s);
  bool holds() const;
  double next_share(bool moving) const;

  CameraRig rig_;
  FramePace pace_;
  View view_;  ///< full size; the eye is the rig's
  double upload_s_ = 0.02;
  std::array<double, 3> walk_{};
  std::array<double, 2> swing_{};
  double held_s_ = 0, advanced_s_ = 0, moved_s_ = -HUGE_VAL;
  bool at_home_ = true;
  CameraPose home_;
  double home_aspect_ = 1;  ///< width by height for which home_ shows the whole scene; 0: it need not
  bool stale_ = true;       ///< something changed since the last order
  double done_share_ = 0;   ///< the largest picture of this pose that is complete
  bool done_ = false;       ///< the full one is
  bool any_drawn_ = false;  ///< of this scene
  std::uint64_t pose_ = 0;  ///< counts what is shown
  double looked_s_ = 0;     ///< when it was first ordered
  double ask_again_s_ = 0;
};

}  // namespace gigabake
