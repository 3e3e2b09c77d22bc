/// A camera controller: orbits around a target, or flies through the scene.
#pragma once

#include <cstdint>

#include "core/base/rules.h"
#include "core/math/frames.h"

namespace gigabake {

/// The maximum magnitude of a camera coordinate.
inline constexpr double max_coordinate_m = 1e12;
/// The maxima of one movement: a drag in image heights, and a turn of the wheel in notches.
inline constexpr double max_heights = 100, max_notches = 100;

/// A camera's position and target.
/// Space   Scene, metres.
struct CameraPose {
  Point<Scene> eye_m, target_m;
  friend bool operator==(const CameraPose&, const CameraPose&) = default;
};

/// A camera whose pose follows user input; a plain value. The scene's z axis always points up in the image.
/// Range   For any argument, NaN included: the pose is finite, eye and target differ, and the view's pitch stays within
///         ±89°. The eye stays within `max_distance_sizes` scene sizes of the home pose's target. A movement that is
///         not finite is ignored.
/// Exact   A pose that is set within the range is returned bit for bit until the next movement.
class CameraController {
 public:
  enum class Style : std::uint8_t {
    orbit,  ///< turn() moves the eye around the target, zoom() moves it towards the target
    fly,    ///< turn() rotates the view around the eye, zoom() changes the speed
  };
  static constexpr double max_pitch_deg = 89, max_distance_sizes = 50, min_distance_sizes = 1e-5;

  /// Takes `home`, a pose that shows the whole scene. The scene's size is the distance between home's eye and target.
  /// An invalid home (not finite, eye equal to target, beyond 10^12 m) is replaced by a view from a distance of about
  /// 100 m.
  explicit CameraController(const CameraPose& home);

  Style style() const { return style_; }
  void set_style(Style style) { style_ = style; }
  const CameraPose& pose() const { return pose_; }
  /// Sets the pose and clamps it to the range of this class; ignores an invalid pose.
  void set_pose(const CameraPose& pose);
  void go_home();

  /// Turns the camera by a mouse drag in image heights. One height moves the eye by 180° around the target in
  /// Style::orbit, and turns the view by 90° in Style::fly.
  void turn(double right, double up);
  /// Moves eye and target across the view by a mouse drag in image heights. At a vertical field of view of `fovy_deg`,
  /// a point at the target's distance follows the mouse.
  void pan(double right, double up, double fovy_deg);
  /// Applies wheel notches, positive towards the scene. Each notch reduces the distance by 10 % in Style::orbit, and
  /// multiplies the speed by 1.25 in Style::fly.
  void zoom(double notches);
  /// Moves eye and target along the view, across the view, and upwards in the scene. `forward`, `right` and `up` are
  /// fractions of speed_m_per_s(), from −1 to 1. The time dt_s is limited to a quarter of a second, so that a pause of
  /// the program causes no jump.
  void walk(double forward, double right, double up, double dt_s);

  double speed_m_per_s() const;

 private:
  double distance_m() const;
  void look(double yaw, double pitch, double distance_m, bool around_target);
  void move(const Point<Scene>& by_m);

  CameraPose home_, pose_;
  double size_m_ = 1, speed_ = 1;
  double yaw_ = 0, pitch_ = 0;  ///< of the view, radians: counterclockwise from east, and above the horizontal
  Style style_ = Style::orbit;
};
template <>
constexpr auto names_of<CameraController::Style>() {
  return std::to_array<std::string_view>({"orbit", "fly"});
}

}  // namespace gigabake
