/// Bookmarked views: one file per digit in a folder, each a camera path of one keyframe (docs/viewer.md).
#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "core/math/frames.h"
#include "viewer/live/camera_controller.h"

namespace gigabake {

class Bookmarks {
 public:
  explicit Bookmarks(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Returns the file of a digit: gigabake-view-1.json for 1.
  std::filesystem::path file_of(int digit) const;

  /// Writes the bookmark of a digit and replaces its previous one.
  /// Errors  InputError: the file cannot be written.
  void keep(int digit, const CameraPose& pose) const;

  /// Returns the bookmarked pose of a digit; nullopt if its file does not exist. `origin` is the scene's origin on the
  /// earth.
  /// Errors  InputError: the errors of read_camera_path().
  std::optional<CameraPose> kept(int digit, const std::optional<Geodetic>& origin) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace gigabake
