#include "viewer/live/render_scheduler.h"

#include <algorithm>
#include <cmath>

namespace gigabake {
namespace {

constexpr int min_edge = 16, max_edge = 4096;
constexpr double min_upload_s = 1e-4, max_upload_s = 1;
/// The minimum length of a preview's longer edge in pixels. It takes precedence over the target time.
constexpr double min_preview_edge = 96;
/// The growth factor of the edges from one image at rest to the next, and the maximum share of images below full size.
/// Images of at most this share add little cost.
constexpr double growth = 2, max_share_before_full = 0.4;

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

bool ViewerInput::moves() const {
  return any(turn) || any(pan) || zoom != 0 || home || (walk && any(*walk)) || (swing && any(*swing)) || pose;
}

RenderScheduler::RenderScheduler(const CameraOptions& home, double frame_s)
    : camera_controller_(pose_of(home)), frame_budget_(frame_s) {
  view_.camera = home;
  view_.camera.up.reset();
  set_home(home);
}

void RenderScheduler::set_home(const CameraOptions& home) {
  home_ = pose_of(home);
  home_aspect_ = home.is_framed ? double(home.width) / home.height : 0;
}

/// Returns home, with the eye moved away from the target if the window is narrower than home's image.
CameraPose RenderScheduler::fitted_home() const {
  const double narrower = home_aspect_ * view_.camera.height / view_.camera.width;
  CameraPose pose = home_;
  if (!(narrower > 1)) return pose;
  const Point<Scene>& at = home_.target_m;
  pose.eye_m = {at.x + (home_.eye_m.x - at.x) * narrower, at.y + (home_.eye_m.y - at.y) * narrower,
                at.z + (home_.eye_m.z - at.z) * narrower};
  return pose;
}

void RenderScheduler::new_scene(const CameraOptions& home) {
  const CameraPose pose = camera_controller_.pose();
  const CameraController::Style style = camera_controller_.style();
  camera_controller_ = CameraController(pose_of(home));
  camera_controller_.set_style(style);
  set_home(home);
  camera_controller_.set_pose(at_home_ ? fitted_home() : pose);
  stale_ = true;
  any_drawn_ = false;
}

void RenderScheduler::steer(const ViewerInput& s, double now_s) {
  advance(now_s);
  apply_settings(s);
  if (s.pose) camera_controller_.set_pose(*s.pose);
  if (s.home) camera_controller_.go_home();
  if (s.home || (s.size && at_home_)) camera_controller_.set_pose(fitted_home());
  camera_controller_.turn(s.turn[0], s.turn[1]);
  camera_controller_.pan(s.pan[0], s.pan[1], view_.camera.fovy_deg);
  camera_controller_.zoom(s.zoom);
  if (s.walk) walk_ = within_one(*s.walk);
  if (s.swing) swing_ = within_one(*s.swing);
  if (s.walk || s.swing) held_s_ = now_s;
  if (!s.moves()) return;
  at_home_ = s.home;
  moved_s_ = now_s;
  stale_ = true;
}

void RenderScheduler::apply_settings(const ViewerInput& s) {
  if (s.style) camera_controller_.set_style(*s.style);
  if (s.upload_s && std::isfinite(*s.upload_s)) upload_s_ = std::clamp(*s.upload_s, min_upload_s, max_upload_s);
  const View before = view_;
  if (s.mode && value_numbered<ViewMode>(std::uint64_t(*s.mode))) view_.mode = *s.mode;
  if (s.pixel_error && std::isfinite(*s.pixel_error))
    view_.camera.pixel_error = std::clamp(*s.pixel_error, finest_pixel_error, coarsest_pixel_error);
  if (s.sun && std::isfinite((*s.sun)[0]) && std::isfinite((*s.sun)[1]))
    view_.sun = {std::clamp((*s.sun)[0], -360.0, 360.0), std::clamp((*s.sun)[1], -90.0, 90.0)};
  if (s.shadows && value_numbered<Shadows>(std::uint64_t(*s.shadows))) view_.shadows = *s.shadows;
  if (s.level_blend && value_numbered<LevelBlend>(std::uint64_t(*s.level_blend))) view_.level_blend = *s.level_blend;
  if (s.size) {
    view_.camera.width = std::clamp((*s.size)[0], min_edge, max_edge);
    view_.camera.height = std::clamp((*s.size)[1], min_edge, max_edge);
  }
  stale_ |= before.mode != view_.mode || before.camera.pixel_error != view_.camera.pixel_error ||
            before.camera.width != view_.camera.width || before.camera.height != view_.camera.height ||
            !(before.sun == view_.sun) || before.shadows != view_.shadows || before.level_blend != view_.level_blend;
}

bool RenderScheduler::holds() const { return any(walk_) || any(swing_); }

void RenderScheduler::advance(double now_s) {
  const double dt_s = std::min(now_s, held_s_ + max_hold_s) - advanced_s_;
  advanced_s_ = std::max(advanced_s_, now_s);
  if (!holds()) return;
  if (dt_s > 0) {
    camera_controller_.walk(walk_[0], walk_[1], walk_[2], dt_s);
    camera_controller_.turn(swing_[0] * dt_s, swing_[1] * dt_s);
    moved_s_ = std::max(moved_s_, std::min(now_s, held_s_ + max_hold_s));
    stale_ = true;
    at_home_ = false;
  }
  if (now_s > held_s_ + max_hold_s) {
    walk_ = {};
    swing_ = {};
  }
}

/// Returns the share that the frame budget allows. At rest, larger shares follow after the first complete image.
double RenderScheduler::next_share(bool moving) const {
  const double minimum = min_preview_edge / std::max(view_.camera.width, view_.camera.height);
  const double share = std::min(1.0, std::max(frame_budget_.share(), minimum));
  if (moving || done_share_ == 0) return share;
  const double larger = std::max(share, done_share_ * growth);
  return larger > max_share_before_full ? 1 : larger;
}

std::optional<RenderScheduler::RenderRequest> RenderScheduler::next(double now_s) {
  advance(now_s);
  if (stale_) {
    done_share_ = 0;
    done_ = stale_ = false;
    looked_s_ = now_s;
    ++pose_;
  }
  const bool moving = holds() || now_s < moved_s_ + rest_s;
  next_call_s_ = moving ? moved_s_ + rest_s : HUGE_VAL;
  if (done_ || (moving && done_share_ > 0)) return std::nullopt;
  RenderRequest order{view_, false, false, moving, next_share(moving), upload_s_, any_drawn_ ? 0 : max_root_wait_s,
                      pose_};
  order.full = order.share >= 1;
  // If a full-size image fits the frame budget, previews refine the whole image at once until no data is missing.
  order.in_tiles = !moving && done_share_ > 0 && (frame_budget_.share() < 1 || done_share_ >= 1);
  if (!moving) order.upload_s = std::clamp(now_s - looked_s_, upload_s_, std::max(upload_s_, max_preview_upload_s));
  order.view.camera.eye_m = camera_controller_.pose().eye_m;
  order.view.camera.target_m = camera_controller_.pose().target_m;
  order.view.camera.width = scaled(view_.camera.width, order.share);
  order.view.camera.height = scaled(view_.camera.height, order.share);
  return order;
}

double RenderScheduler::next_call_s() const { return next_call_s_; }

void RenderScheduler::drawn(const RenderRequest& order, const FrameStats& stats) {
  any_drawn_ = true;
  if (order.in_tiles) {
    if (stats.complete) done_share_ = order.share;
    done_ = stats.complete && order.full;
    return;
  }
  // Uploads at rest have a longer time limit. Subtract the excess to estimate the time of a frame during movement.
  frame_budget_.took(stats.total_s - std::max(0.0, stats.upload_s - upload_s_), order.share);
  const bool nothing_comes = stats.starved || (stats.uploads == 0 && stats.pages_loading == 0);
  if (stats.complete || nothing_comes) done_share_ = order.share;
  done_ = stats.complete && order.full;
}

void RenderScheduler::failed() { done_ = true; }

}  // namespace gigabake
