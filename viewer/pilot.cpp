#include "viewer/pilot.h"

#include <algorithm>
#include <cmath>

namespace gigabake {
namespace {

constexpr int least_edge = 16, most_edge = 4096;
constexpr double least_upload_s = 1e-4, most_upload_s = 1;
/// At rest nobody waits for the next frame, but for the last one.
constexpr double resting_upload_s = 0.25;

CameraPose pose_of(const CameraOptions& camera) {
  return {camera.eye_m.value_or(Point<Scene>{}), camera.target_m.value_or(Point<Scene>{})};
}

template <std::size_t n>
bool any(const std::array<double, n>& v) {
  return std::any_of(v.begin(), v.end(), [](double x) { return x != 0; });
}

template <std::size_t n>
std::array<double, n> within_one(std::array<double, n> v) {
  for (double& x : v) x = std::isfinite(x) ? std::clamp(x, -1.0, 1.0) : 0;
  return v;
}

int scaled(int edge, double share) { return std::max(1, int(std::lround(edge * share))); }

}  // namespace

bool Steering::moves() const {
  return any(turn) || any(pan) || zoom != 0 || home || (walk && any(*walk)) || (swing && any(*swing)) || pose;
}

Pilot::Pilot(const CameraOptions& home, double frame_s) : rig_(pose_of(home)), pace_(frame_s) {
  view_.camera = home;
  view_.camera.up.reset();
}

void Pilot::new_scene(const CameraOptions& home) {
  const CameraPose pose = rig_.pose();
  const CameraRig::Style style = rig_.style();
  rig_ = CameraRig(pose_of(home));
  rig_.set_style(style);
  if (!at_home_) rig_.set_pose(pose);
  stale_ = true;
}

void Pilot::steer(const Steering& s, double now_s) {
  advance(now_s);
  apply_settings(s);
  if (s.pose) rig_.set_pose(*s.pose);
  if (s.home) rig_.go_home();
  rig_.turn(s.turn[0], s.turn[1]);
  rig_.pan(s.pan[0], s.pan[1], view_.camera.fovy_deg);
  rig_.zoom(s.zoom);
  if (s.walk) walk_ = within_one(*s.walk);
  if (s.swing) swing_ = within_one(*s.swing);
  if (s.walk || s.swing) held_s_ = now_s;
  if (!s.moves()) return;
  at_home_ = s.home;
  moved_s_ = now_s;
  stale_ = true;
}

void Pilot::apply_settings(const Steering& s) {
  if (s.style) rig_.set_style(*s.style);
  if (s.upload_s && std::isfinite(*s.upload_s)) upload_s_ = std::clamp(*s.upload_s, least_upload_s, most_upload_s);
  const View before = view_;
  if (s.mode && std::size_t(*s.mode) < view_mode_names().size()) view_.mode = *s.mode;
  if (s.pixel_error && std::isfinite(*s.pixel_error))
    view_.camera.pixel_error = std::clamp(*s.pixel_error, finest_pixel_error, coarsest_pixel_error);
  if (s.size) {
    view_.camera.width = std::clamp((*s.size)[0], least_edge, most_edge);
    view_.camera.height = std::clamp((*s.size)[1], least_edge, most_edge);
  }
  stale_ |= before.mode != view_.mode || before.camera.pixel_error != view_.camera.pixel_error ||
            before.camera.width != view_.camera.width || before.camera.height != view_.camera.height;
}

bool Pilot::holds() const { return any(walk_) || any(swing_); }

void Pilot::advance(double now_s) {
  const double dt_s = std::min(now_s, held_s_ + longest_hold_s) - advanced_s_;
  advanced_s_ = std::max(advanced_s_, now_s);
  if (!holds()) return;
  if (dt_s > 0) {
    rig_.walk(walk_[0], walk_[1], walk_[2], dt_s);
    rig_.turn(swing_[0] * dt_s, swing_[1] * dt_s);
    moved_s_ = std::max(moved_s_, std::min(now_s, held_s_ + longest_hold_s));
    stale_ = true;
    at_home_ = false;
  }
  if (now_s > held_s_ + longest_hold_s) {
    walk_ = {};
    swing_ = {};
  }
}

std::optional<Pilot::Order> Pilot::next(double now_s) {
  advance(now_s);
  if (stale_) small_done_ = done_ = stale_ = false;
  const bool moving = holds() || now_s < moved_s_ + rest_s;
  ask_again_s_ = moving ? moved_s_ + rest_s : HUGE_VAL;
  if (done_ || (moving && small_done_)) return std::nullopt;
  Order order{view_, !moving, moving ? pace_.share() : 1, moving ? upload_s_ : std::max(upload_s_, resting_upload_s)};
  order.full = order.share >= 1;
  order.view.camera.eye_m = rig_.pose().eye_m;
  order.view.camera.target_m = rig_.pose().target_m;
  order.view.camera.width = scaled(view_.camera.width, order.share);
  order.view.camera.height = scaled(view_.camera.height, order.share);
  return order;
}

double Pilot::ask_again_s() const { return ask_again_s_; }

void Pilot::drawn(const Order& order, const FrameStats& stats) {
  pace_.took(stats.total_s, order.share);
  if (stats.complete) (order.full ? done_ : small_done_) = true;
}

void Pilot::failed() { done_ = true; }

}  // namespace gigabake
