/// A camera's way through a scene: keyframes in a JSON file, and what lies between them (docs/viewer.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lattice/frames.h"
#include "viewer/live/camera_rig.h"
#include "viewer/pictures/camera.h"

namespace gigabake {

struct CameraKeyframe {
  double time_s = 0;
  CameraPose pose;
  std::optional<double> fovy_deg;  ///< none: that of the picture
  std::optional<Point<Scene>> up;  ///< none: z
  friend bool operator==(const CameraKeyframe&, const CameraKeyframe&) = default;
};

/// Eye, target, field of view and up are cubic Hermite curves over time. The slope at a keyframe is that of the
/// parabola through it and its two neighbours (Catmull-Rom for uneven times); it is 0 beside two keyframes that are
/// equal: there the camera rests. Exact   A keyframe's time gives the keyframe; equal keyframes give it at every time
/// between.
class CameraPath {
 public:
  /// Times rise strictly, eye and target lie apart. Errors  UsageError: they do not, or there is no keyframe.
  explicit CameraPath(std::vector<CameraKeyframe> keyframes);

  double first_s() const { return keyframes_.front().time_s; }
  double last_s() const { return keyframes_.back().time_s; }
  const std::vector<CameraKeyframe>& keyframes() const { return keyframes_; }

  /// Before the first keyframe as there, after the last as there. camera: what the path leaves open.
  CameraOptions at(double time_s, const CameraOptions& camera) const;

  friend bool operator==(const CameraPath&, const CameraPath&) = default;

 private:
  std::vector<CameraKeyframe> keyframes_;
};

/// origin: the scene's, for paths in degrees. file: for messages.
/// Errors  InputError: not JSON, or a member that is unknown, missing, of another type or out of range; degrees where
///         the scene stands nowhere on the earth.
CameraPath camera_path_from_json(const std::filesystem::path& file, std::string_view text,
                                 const std::optional<Geodetic>& origin);
/// Errors  InputError: no such file, larger than 16 MiB, or as camera_path_from_json().
CameraPath read_camera_path(const std::filesystem::path& file, const std::optional<Geodetic>& origin);

/// In scene metres. Exact  camera_path_from_json() returns the same path.
std::string to_json(const CameraPath& path);

/// Keyframes from a viewer's poses, as they come.
class PathRecorder {
 public:
  /// Takes a keyframe where half a second or more has passed since the last one. now_s never runs back.
  void see(const CameraPose& pose, double now_s);
  /// The way so far up to the pose seen last; nothing before the first pose.
  std::optional<CameraPath> path() const;

 private:
  std::vector<CameraKeyframe> keyframes_;
  std::optional<CameraKeyframe> last_;
  double start_s_ = 0;
};

}  // namespace gigabake
