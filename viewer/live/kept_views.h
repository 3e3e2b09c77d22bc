/// Views that somebody keeps under a digit: camera paths of one keyframe (docs/viewer.md), in a folder.
#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "lattice/frames.h"
#include "viewer/live/camera_rig.h"

namespace gigabake {

class KeptViews {
 public:
  explicit KeptViews(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// gigabake-view-1.json and on.
  std::filesystem::path file_of(int digit) const;

  /// In place of what was kept so. Errors  InputError: the file cannot be written.
  void keep(int digit, const CameraPose& pose) const;

  /// Nothing where no such file is. origin: the scene's. Errors  InputError: as read_camera_path().
  std::optional<CameraPose> kept(int digit, const std::optional<Geodetic>& origin) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace gigabake
