/// A camera path through a scene: keyframes in a JSON file, interpolated over time (docs/viewer.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/frames.h"
#include "viewer/live/camera_controller.h"
#include "viewer/pictures/camera.h"

namespace gigabake {

struct CameraKeyframe {
  double time_s = 0;
  CameraPose pose;
  std::optional<double> fovy_deg;  ///< nullopt: the field of view passed to at()
  std::optional<Point<Scene>> up;  ///< nullopt: the up vector passed to at(), by default z
  friend bool operator==(const CameraKeyframe&, const CameraKeyframe&) = default;
};

/// A path on which eye, target, field of view and up vector are cubic Hermite curves over time. The slope at a keyframe
/// equals the slope of the parabola through this keyframe and its two neighbours (Catmull-Rom for uneven times). If two
/// consecutive keyframes are equal, both slopes are 0, so the camera rests between them.
/// Exact   At a keyframe's time the result is the keyframe. Between two equal keyframes the result is that keyframe.
class CameraPath {
 public:
  /// Takes keyframes with strictly increasing times; in each keyframe, eye and target must differ.
  /// Errors  UsageError: the keyframes violate a condition, or there are none.
  explicit CameraPath(std::vector<CameraKeyframe> keyframes);

  double first_s() const { return keyframes_.front().time_s; }
  double last_s() const { return keyframes_.back().time_s; }
  const std::vector<CameraKeyframe>& keyframes() const { return keyframes_; }

  /// Returns the interpolated camera; times outside the path are clamped to its first or last keyframe. `camera`
  /// supplies the values that the path does not define.
  CameraOptions at(double time_s, const CameraOptions& camera) const;

  friend bool operator==(const CameraPath&, const CameraPath&) = default;

 private:
  std::vector<CameraKeyframe> keyframes_;
};

/// Parses a camera path. `origin` is the scene's origin on the earth; paths in degrees need it. `file` is used only in
/// messages.
/// Errors  InputError: not JSON, or degrees although the scene has no origin on the earth. InputError: a member that is
///         unknown, missing, of a wrong type or out of range.
CameraPath camera_path_from_json(const std::filesystem::path& file, std::string_view text,
                                 const std::optional<Geodetic>& origin);
/// Reads and parses a camera path.
/// Errors  InputError: the file does not exist or exceeds 16 MiB. The errors of camera_path_from_json().
CameraPath read_camera_path(const std::filesystem::path& file, const std::optional<Geodetic>& origin);

/// Returns the path as JSON in scene metres.
/// Exact   camera_path_from_json() of the text returns the same path.
std::string to_json(const CameraPath& path);

/// A recorder of keyframes from the successive poses of a viewer.
class PathRecorder {
 public:
  /// Records the pose. The pose becomes a keyframe if at least half a second has passed since the last keyframe.
  /// Range   now_s does not decrease between calls.
  void see(const CameraPose& pose, double now_s);
  /// Returns the path up to the last recorded pose; nullopt before the first pose.
  std::optional<CameraPath> path() const;

 private:
  std::vector<CameraKeyframe> keyframes_;
  std::optional<CameraKeyframe> last_;
  double start_s_ = 0;
};

}  // namespace gigabake
