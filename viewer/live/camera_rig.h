/// How hands move a camera: around a target, or through the scene.
#pragma once

#include <cstdint>

#include "lattice/frames.h"
#include "lattice/rules.h"

namespace gigabake {

/// Of any coordinate of a camera.
inline constexpr double farthest_m = 1e12;
/// Of one movement: heights of the picture dragged, notches of the wheel.
inline constexpr double most_heights = 100, most_notches = 100;

/// Where a camera stands and what it looks at. Space  Scene, metres.
struct CameraPose {
  Point<Scene> eye_m, target_m;
  friend bool operator==(const CameraPose&, const CameraPose&) = default;
};

/// A value; z stays up in the picture.
/// Range   Whatever is asked, NaN included: the pose is finite, eye and target lie apart, the view is at most 89°
/// steep,
///         and the eye stays within `farthest_sizes` scene sizes of home. An argument that is not finite does nothing.
/// Exact   A pose that was set is given back bit for bit until something moves.
class CameraRig {
 public:
  enum class Style : std::uint8_t {
    orbit,  ///< turning goes around the target, zooming towards it
    fly,    ///< turning looks around, zooming changes the speed
  };
  static constexpr double steepest_deg = 89, farthest_sizes = 50, nearest_sizes = 1e-5;

  /// home: sees the whole scene; the scene's size is the distance from eye to target. One that is no pose (not finite,
  /// eye and target in one place, beyond 10^12 m) becomes a view over 100 m.
  explicit CameraRig(const CameraPose& home);

  Style style() const { return style_; }
  void set_style(Style style) { style_ = style; }
  const CameraPose& pose() const { return pose_; }
  /// Ignored where it is no pose; else brought into range.
  void set_pose(const CameraPose& pose);
  void go_home();

  /// As a mouse drags, in picture heights; a height is 180° around the target, and 90° of looking around.
  void turn(double right, double up);
  /// Moves eye and target across the view, in picture heights at the target: what is dragged stays under the mouse for
  /// a field of view of `fovy_deg`.
  void pan(double right, double up, double fovy_deg);
  /// Wheel notches, positive towards the scene. orbit: a tenth nearer each; fly: a quarter faster.
  void zoom(double notches);
  /// Moves eye and target along the view, across it, and upwards in the scene; shares of full speed, at most 1 each.
  /// Longer steps than a quarter of a second count as that: a pause of the program is no jump.
  void walk(double forward, double right, double up, double dt_s);

  double speed_m_per_s() const;

 private:
  double distance_m() const;
  void look(double yaw, double pitch, double distance_m, bool around_target);
  void move(const Point<Scene>& by_m);

  CameraPose home_, pose_;
  double size_m_ = 1, speed_ = 1;
  double yaw_ = 0, pitch_ = 0;  ///< of the view: from east to north, and upwards; radians
  Style style_ = Style::orbit;
};
template <>
constexpr auto names_of<CameraRig::Style>() {
  return std::to_array<std::string_view>({"orbit", "fly"});
}

}  // namespace gigabake
