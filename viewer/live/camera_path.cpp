#include "viewer/live/camera_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr double record_every_s = 0.5;

template <std::size_t n>
using Values = std::array<double, n>;

Values<3> values(const Point<Scene>& p) { return {p.x, p.y, p.z}; }
Point<Scene> point(const Values<3>& v) { return {v[0], v[1], v[2]}; }

/// A segment of a curve and its neighbours: four keyframes, of which the outer two may be missing.
template <std::size_t n>
struct CurveSegment {
  std::optional<Values<n>> before, after;
  Values<n> from, to;
  double before_s = 0, from_s = 0, to_s = 0, after_s = 0;
};

/// Returns the slope, at the middle one of three points, of the parabola through these points. `ab_s` and `bc_s` are
/// the times between consecutive points.
double slope(double a, double b, double c, double ab_s, double bc_s) {
  return ((b - a) / ab_s * bc_s + (c - b) / bc_s * ab_s) / (ab_s + bc_s);
}

template <std::size_t n>
Values<n> between(const CurveSegment<n>& s, double time_s) {
  if (s.from == s.to) return s.from;
  const double width_s = s.to_s - s.from_s, u = (time_s - s.from_s) / width_s;
  const bool leaves = s.before && *s.before == s.from, arrives = s.after && *s.after == s.to;
  Values<n> out;
  for (std::size_t k = 0; k < n; ++k) {
    const double straight = (s.to[k] - s.from[k]) / width_s;
    double first = straight, last = straight;
    if (s.before) first = slope((*s.before)[k], s.from[k], s.to[k], s.from_s - s.before_s, width_s);
    if (s.after) last = slope(s.from[k], s.to[k], (*s.after)[k], width_s, s.after_s - s.to_s);
    if (leaves) first = 0;
    if (arrives) last = 0;
    out[k] = s.from[k] + (s.to[k] - s.from[k]) * (u * u * (3 - 2 * u)) +
             width_s * (first * u * (1 - u) * (1 - u) - last * u * u * (1 - u));
  }
  return out;
}

/// Interpolates between keyframes i and i + 1. `of` returns the values of a keyframe that are interpolated.
template <std::size_t n, class Of>
Values<n> interpolate(const std::vector<CameraKeyframe>& keys, std::size_t i, double time_s, const Of& of) {
  CurveSegment<n> s;
  s.from = of(keys[i]);
  s.to = of(keys[i + 1]);
  s.from_s = keys[i].time_s;
  s.to_s = keys[i + 1].time_s;
  if (i > 0) {
    s.before = of(keys[i - 1]);
    s.before_s = keys[i - 1].time_s;
  }
  if (i + 2 < keys.size()) {
    s.after = of(keys[i + 2]);
    s.after_s = keys[i + 2].time_s;
  }
  return between(s, time_s);
}

void set(CameraOptions& camera, const CameraKeyframe& key) {
  camera.eye_m = key.pose.eye_m;
  camera.target_m = key.pose.target_m;
  if (key.fovy_deg) camera.fovy_deg = *key.fovy_deg;
  if (key.up) camera.up = key.up;
}

}  // namespace

CameraPath::CameraPath(std::vector<CameraKeyframe> keyframes) : keyframes_(std::move(keyframes)) {
  if (keyframes_.empty()) throw UsageError("a camera path needs at least one keyframe");
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    const std::string where = "keyframes[" + std::to_string(i) + "]";
    if (i > 0 && !(keyframes_[i].time_s > keyframes_[i - 1].time_s))
      throw UsageError(where + ".time_s: expected more than that of the previous keyframe");
    if (keyframes_[i].pose.eye_m == keyframes_[i].pose.target_m)
      throw UsageError(where + ".target: the same place as the eye; there is no direction to look");
  }
}

CameraOptions CameraPath::at(double time_s, const CameraOptions& camera) const {
  CameraOptions out = camera;
  const auto next = std::upper_bound(keyframes_.begin(), keyframes_.end(), time_s,
                                     [](double t, const CameraKeyframe& key) { return t < key.time_s; });
  if (next == keyframes_.begin() || next == keyframes_.end() || next[-1].time_s == time_s) {
    set(out, next == keyframes_.begin() ? *next : next[-1]);
    return out;
  }
  const std::size_t i = std::size_t(next - keyframes_.begin()) - 1;
  const auto curve = [&]<std::size_t n>(const auto& of) { return interpolate<n>(keyframes_, i, time_s, of); };
  CameraKeyframe key;
  key.pose.eye_m = point(curve.operator()<3>([](const CameraKeyframe& k) { return values(k.pose.eye_m); }));
  key.pose.target_m = point(curve.operator()<3>([](const CameraKeyframe& k) { return values(k.pose.target_m); }));
  const Point<Scene> up = camera.up.value_or(Point<Scene>{0, 0, 1});
  const bool turns = std::any_of(keyframes_.begin(), keyframes_.end(), [](const auto& k) { return k.up.has_value(); });
  if (turns) key.up = point(curve.operator()<3>([&](const CameraKeyframe& k) { return values(k.up.value_or(up)); }));
  const double fovy_deg =
      curve.operator()<1>([&](const CameraKeyframe& k) { return Values<1>{k.fovy_deg.value_or(camera.fovy_deg)}; })[0];
  key.fovy_deg = std::clamp(fovy_deg, 0.01, 170.0);  // a curve may overshoot its keyframes
  set(out, key);
  return out;
}

void PathRecorder::see(const CameraPose& pose, double now_s) {
  if (keyframes_.empty()) start_s_ = now_s;
  last_ = CameraKeyframe{now_s - start_s_, pose, std::nullopt, std::nullopt};
  if (keyframes_.empty() || last_->time_s >= keyframes_.back().time_s + record_every_s) keyframes_.push_back(*last_);
}

std::optional<CameraPath> PathRecorder::path() const {
  if (!last_) return std::nullopt;
  std::vector<CameraKeyframe> keyframes = keyframes_;
  if (last_->time_s > keyframes.back().time_s) keyframes.push_back(*last_);
  return CameraPath(std::move(keyframes));
}

}  // namespace gigabake
