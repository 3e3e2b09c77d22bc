#include "viewer/live/camera_controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gigabake {
namespace {

constexpr double pi = std::numbers::pi, max_pitch = CameraController::max_pitch_deg * pi / 180;
constexpr double max_step_s = 0.25;
constexpr double min_size_m = 1e-3;

using P = Point<Scene>;

P plus(const P& a, const P& b, double s) { return {a.x + b.x * s, a.y + b.y * s, a.z + b.z * s}; }
double distance(const P& a, const P& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }
bool in_reach(const P& p) {
  return std::fabs(p.x) <= max_coordinate_m && std::fabs(p.y) <= max_coordinate_m && std::fabs(p.z) <= max_coordinate_m;
}
bool is_pose(const CameraPose& p) { return in_reach(p.eye_m) && in_reach(p.target_m) && !(p.eye_m == p.target_m); }

bool finite(double a, double b) { return std::isfinite(a) && std::isfinite(b); }

P direction(double yaw, double pitch) {
  return {std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch)};
}
P to_the_right(double yaw) { return {std::sin(yaw), -std::cos(yaw), 0}; }
P upwards(double yaw, double pitch) {
  return {-std::cos(yaw) * std::sin(pitch), -std::sin(yaw) * std::sin(pitch), std::cos(pitch)};
}

/// Returns the point of the ball around `centre` that is nearest to p.
P within(const P& p, const P& centre, double radius) {
  const double far = distance(p, centre);
  if (far <= radius) return p;
  const P out{p.x - centre.x, p.y - centre.y, p.z - centre.z};
  return plus(centre, out, radius / far * (1 - 1e-12));
}

}  // namespace

CameraController::CameraController(const CameraPose& home)
    : home_(is_pose(home) ? home : CameraPose{{60, -60, 50}, {0, 0, 0}}) {
  const P& at = home_.target_m;
  // The minimum size of the scene at which coordinates of this magnitude resolve steps at the minimum distance.
  const double finest_m = 1e-9 * std::max({std::fabs(at.x), std::fabs(at.y), std::fabs(at.z)});
  size_m_ = std::max({distance(home_.eye_m, at), min_size_m, finest_m});
  go_home();
}

void CameraController::go_home() {
  speed_ = 1;
  set_pose(home_);
}

double CameraController::distance_m() const { return distance(pose_.eye_m, pose_.target_m); }

double CameraController::speed_m_per_s() const { return size_m_ * 0.25 * speed_; }

void CameraController::set_pose(const CameraPose& pose) {
  if (!is_pose(pose)) return;
  const P by{pose.target_m.x - pose.eye_m.x, pose.target_m.y - pose.eye_m.y, pose.target_m.z - pose.eye_m.z};
  const double flat = std::hypot(by.x, by.y), far = std::hypot(flat, by.z);
  if (flat > 0) yaw_ = std::atan2(by.y, by.x);
  pitch_ = std::atan2(by.z, flat);
  pose_ = pose;
  pose_.eye_m = within(pose.eye_m, home_.target_m, max_distance_sizes * size_m_);
  const bool moved = !(pose_.eye_m == pose.eye_m), steep = std::fabs(pitch_) > max_pitch;
  const bool strange = far < min_distance_sizes * size_m_ || far > max_distance_sizes * size_m_;
  if (moved || steep || strange) look(yaw_, pitch_, far, false);
}

void CameraController::look(double yaw, double pitch, double far_m, bool around_target) {
  yaw_ = std::remainder(yaw, 2 * pi);
  pitch_ = std::clamp(pitch, -max_pitch, max_pitch);
  far_m = std::clamp(far_m, min_distance_sizes * size_m_, max_distance_sizes * size_m_);
  const P forward = direction(yaw_, pitch_);
  if (around_target) {
    pose_.eye_m = within(plus(pose_.target_m, forward, -far_m), home_.target_m, max_distance_sizes * size_m_);
  }
  pose_.target_m = plus(pose_.eye_m, forward, far_m);
}

void CameraController::turn(double right, double up) {
  if (!finite(right, up) || (right == 0 && up == 0)) return;
  right = std::clamp(right, -max_heights, max_heights);
  up = std::clamp(up, -max_heights, max_heights);
  const double height = style_ == Style::orbit ? pi : pi / 2;
  look(yaw_ - right * height, pitch_ + up * height, distance_m(), style_ == Style::orbit);
}

void CameraController::move(const P& by_m) {
  const double far_m = distance_m();
  pose_.eye_m = within(plus(pose_.eye_m, by_m, 1), home_.target_m, max_distance_sizes * size_m_);
  look(yaw_, pitch_, far_m, false);
}

void CameraController::pan(double right, double up, double fovy_deg) {
  if (!finite(right, up) || !(fovy_deg > 0 && fovy_deg < 180) || (right == 0 && up == 0)) return;
  right = std::clamp(right, -max_heights, max_heights);
  up = std::clamp(up, -max_heights, max_heights);
  const double height_m = 2 * distance_m() * std::tan(fovy_deg * pi / 360);
  const P by = plus(P{}, to_the_right(yaw_), -right * height_m);
  move(plus(by, upwards(yaw_, pitch_), -up * height_m));
}

void CameraController::zoom(double notches) {
  if (!std::isfinite(notches) || notches == 0) return;
  notches = std::clamp(notches, -max_notches, max_notches);
  if (style_ == Style::fly) {
    speed_ = std::clamp(speed_ * std::pow(1.25, notches), 1e-4, 1e2);
  } else {
    look(yaw_, pitch_, distance_m() * std::pow(0.9, notches), true);
  }
}

void CameraController::walk(double forward, double right, double up, double dt_s) {
  if (!finite(forward, right) || !finite(up, dt_s) || dt_s <= 0) return;
  if (forward == 0 && right == 0 && up == 0) return;
  const double step_m = speed_m_per_s() * std::min(dt_s, max_step_s);
  P by = plus(P{}, direction(yaw_, pitch_), std::clamp(forward, -1.0, 1.0) * step_m);
  by = plus(by, to_the_right(yaw_), std::clamp(right, -1.0, 1.0) * step_m);
  move(plus(by, P{0, 0, 1}, std::clamp(up, -1.0, 1.0) * step_m));
}

}  // namespace gigabake
