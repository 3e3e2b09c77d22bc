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
  std::optional<double> fovy_deg;  ///< none: the field of view of the image
  std::optional<Point<Scene>> up;  ///< none: z
  friend bool operator==(const CameraKeyframe&, const CameraKeyframe&) = default;
};

/// Eye, target, field of view and up vector are cubic Hermite curves over time. The slope at a keyframe is that of the
/// parabola through it and its two neighbours (Catmull-Rom for uneven times). The slope is 0 next to two consecutive
/// equal keyframes, so the camera rests between them.
/// Exact   At a keyframe's time the result is the keyframe. Between two equal keyframes the result is that keyframe.
class CameraPath {
 public:
  /// Takes keyframes whose times increase strictly and whose eye and target differ.
  /// Errors  UsageError: the keyframes violate this, or there are none.
  explicit CameraPath(std::vector<CameraKeyframe> keyframes);

  double first_s() const { return keyframes_.front().time_s; }
  double last_s() const { return keyframes_.back().time_s; }
  const std::vector<CameraKeyframe>& keyframes() const { return keyframes_; }

  /// Returns the interpolated camera; times outside the path are clamped to its first or last keyframe. camera: the
  /// values that the path does not define.
  CameraOptions at(double time_s, const CameraOptions& camera) const;

  friend bool operator==(const CameraPath&, const CameraPath&) = default;

 private:
  std::vector<CameraKeyframe> keyframes_;
};

/// Parses a camera path. origin: the scene's; paths in degrees need it. file: for messages.
/// Errors  InputError: not JSON, or degrees although the scene has no origin on the earth. InputError: a member that is
///         unknown, missing, of a wrong type or out of range.
CameraPath camera_path_from_json(const std::filesystem::path& file, std::string_view text,
                                 const std::optional<Geodetic>& origin);
/// Reads and parses a camera path.
/// Errors  InputError: no such file, a file larger than 16 MiB, or an error of camera_path_from_json().
CameraPath read_camera_path(const std::filesystem::path& file, const std::optional<Geodetic>& origin);

/// Returns the path as JSON in scene metres.
/// Exact   camera_path_from_json() of the text returns the same path.
std::string to_json(const CameraPath& path);

/// Records keyframes from the successive poses of a viewer.
class PathRecorder {
 public:
  /// Adds a keyframe if half a second or more has passed since the last one. now_s never decreases.
  void see(const CameraPose& pose, double now_s);
  /// Returns the path up to the last recorded pose; nullopt before the first pose.
  std::optional<CameraPath> path() const;

 private:
  std::vector<CameraKeyframe> keyframes_;
  std::optional<CameraKeyframe> last_;
  double start_s_ = 0;
};

}  // namespace gigabake
