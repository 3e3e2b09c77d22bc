#include "viewer/live/camera_rig.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gigabake {
namespace {

constexpr double pi = std::numbers::pi, steepest = CameraRig::steepest_deg * pi / 180;
constexpr double longest_step_s = 0.25;
constexpr double nearest_size_m = 1e-3;

using P = Point<Scene>;

P plus(const P& a, const P& b, double s) { return {a.x + b.x * s, a.y + b.y * s, a.z + b.z * s}; }
double distance(const P& a, const P& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }
bool in_reach(const P& p) {
  return std::fabs(p.x) <= farthest_m && std::fabs(p.y) <= farthest_m && std::fabs(p.z) <= farthest_m;
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

/// Returns the nearest point of the ball.
P within(const P& p, const P& centre, double radius) {
  const double far = distance(p, centre);
  if (far <= radius) return p;
  const P out{p.x - centre.x, p.y - centre.y, p.z - centre.z};
  return plus(centre, out, radius / far * (1 - 1e-12));
}

}  // namespace

CameraRig::CameraRig(const CameraPose& home) : home_(is_pose(home) ? home : CameraPose{{60, -60, 50}, {0, 0, 0}}) {
  const P& at = home_.target_m;
  // Coordinates of this magnitude must still resolve a step of the smallest distance.
  const double finest_m = 1e-9 * std::max({std::fabs(at.x), std::fabs(at.y), std::fabs(at.z)});
  size_m_ = std::max({distance(home_.eye_m, at), nearest_size_m, finest_m});
  go_home();
}

void CameraRig::go_home() {
  speed_ = 1;
  set_pose(home_);
}

double CameraRig::distance_m() const { return distance(pose_.eye_m, pose_.target_m); }

double CameraRig::speed_m_per_s() const { return size_m_ * 0.25 * speed_; }

void CameraRig::set_pose(const CameraPose& pose) {
  if (!is_pose(pose)) return;
  const P by{pose.target_m.x - pose.eye_m.x, pose.target_m.y - pose.eye_m.y, pose.target_m.z - pose.eye_m.z};
  const double flat = std::hypot(by.x, by.y), far = std::hypot(flat, by.z);
  if (flat > 0) yaw_ = std::atan2(by.y, by.x);
  pitch_ = std::atan2(by.z, flat);
  pose_ = pose;
  pose_.eye_m = within(pose.eye_m, home_.target_m, farthest_sizes * size_m_);
  const bool moved = !(pose_.eye_m == pose.eye_m), steep = std::fabs(pitch_) > steepest;
  const bool strange = far < nearest_sizes * size_m_ || far > farthest_sizes * size_m_;
  if (moved || steep || strange) look(yaw_, pitch_, far, false);
}

void CameraRig::look(double yaw, double pitch, double far_m, bool around_target) {
  yaw_ = std::remainder(yaw, 2 * pi);
  pitch_ = std::clamp(pitch, -steepest, steepest);
  far_m = std::clamp(far_m, nearest_sizes * size_m_, farthest_sizes * size_m_);
  const P forward = direction(yaw_, pitch_);
  if (around_target) {
    pose_.eye_m = within(plus(pose_.target_m, forward, -far_m), home_.target_m, farthest_sizes * size_m_);
  }
  pose_.target_m = plus(pose_.eye_m, forward, far_m);
}

void CameraRig::turn(double right, double up) {
  if (!finite(right, up) || (right == 0 && up == 0)) return;
  right = std::clamp(right, -most_heights, most_heights);
  up = std::clamp(up, -most_heights, most_heights);
  const double height = style_ == Style::orbit ? pi : pi / 2;
  look(yaw_ - right * height, pitch_ + up * height, distance_m(), style_ == Style::orbit);
}

void CameraRig::move(const P& by_m) {
  const double far_m = distance_m();
  pose_.eye_m = within(plus(pose_.eye_m, by_m, 1), home_.target_m, farthest_sizes * size_m_);
  look(yaw_, pitch_, far_m, false);
}

void CameraRig::pan(double right, double up, double fovy_deg) {
  if (!finite(right, up) || !(fovy_deg > 0 && fovy_deg < 180) || (right == 0 && up == 0)) return;
  right = std::clamp(right, -most_heights, most_heights);
  up = std::clamp(up, -most_heights, most_heights);
  const double height_m = 2 * distance_m() * std::tan(fovy_deg * pi / 360);
  const P by = plus(P{}, to_the_right(yaw_), -right * height_m);
  move(plus(by, upwards(yaw_, pitch_), -up * height_m));
}

void CameraRig::zoom(double notches) {
  if (!std::isfinite(notches) || notches == 0) return;
  notches = std::clamp(notches, -most_notches, most_notches);
  if (style_ == Style::fly) {
    speed_ = std::clamp(speed_ * std::pow(1.25, notches), 1e-4, 1e2);
  } else {
    look(yaw_, pitch_, distance_m() * std::pow(0.9, notches), true);
  }
}

void CameraRig::walk(double forward, double right, double up, double dt_s) {
  if (!finite(forward, right) || !finite(up, dt_s) || dt_s <= 0) return;
  if (forward == 0 && right == 0 && up == 0) return;
  const double step_m = speed_m_per_s() * std::min(dt_s, longest_step_s);
  P by = plus(P{}, direction(yaw_, pitch_), std::clamp(forward, -1.0, 1.0) * step_m);
  by = plus(by, to_the_right(yaw_), std::clamp(right, -1.0, 1.0) * step_m);
  move(plus(by, P{0, 0, 1}, std::clamp(up, -1.0, 1.0) * step_m));
}

}  // namespace gigabake
