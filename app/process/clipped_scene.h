/// The part of a scene in an area of interest, as a temporary scene.
#pragma once

#include <filesystem>
#include <optional>

#include "app/options/area_options.h"
#include "cluster/process/temporary_folder.h"

namespace gigabake::app {

/// A scene for one command. Without an area it is the scene itself.
class ClippedScene {
 public:
  /// Clips the scene if the options have an area. `shows_progress`: prints the steps to standard error.
  /// Errors  The errors of AreaOptions::area() and clip_scene().
  ClippedScene(const std::filesystem::path& scene_xml, const AreaOptions& options, int threads, bool shows_progress);

  const std::filesystem::path& file() const { return file_; }

 private:
  std::optional<TemporaryFolder> folder_;
  std::filesystem::path file_;
};

}  // namespace gigabake::app
