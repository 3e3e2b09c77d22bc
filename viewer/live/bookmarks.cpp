#include "viewer/live/bookmarks.h"

#include <fmt/format.h>

#include "format/system/publish.h"
#include "viewer/live/camera_path.h"

namespace gigabake {

std::filesystem::path Bookmarks::file_of(int digit) const {
  return folder_ / fmt::format("gigabake-view-{}.json", digit);
}

void Bookmarks::keep(int digit, const CameraPose& pose) const {
  publish_file(file_of(digit), to_json(CameraPath({{0, pose, {}, {}}})));
}

std::optional<CameraPose> Bookmarks::kept(int digit, const std::optional<Geodetic>& origin) const {
  if (!std::filesystem::exists(file_of(digit))) return {};
  return read_camera_path(file_of(digit), origin).keyframes().front().pose;
}

}  // namespace gigabake
