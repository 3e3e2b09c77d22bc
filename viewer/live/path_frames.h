/// Rendering of the images along a camera path.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "viewer/live/camera_path.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// Returns `frames` evenly spaced times from the first keyframe to the last; for 1, the time of the first keyframe.
std::vector<double> times_of_frames(const CameraPath& path, int frames);
/// Returns times from the first keyframe on, in steps of 1 / frames_per_s; none is after the last keyframe.
std::vector<double> times_at_rate(const CameraPath& path, double frames_per_s);

/// Returns the pattern with the number inserted: "frames/%04d.png" and 7 give "frames/0007.png". `field` is the
/// option's name in the error message.
/// Errors  UsageError: the pattern does not contain exactly one %d, or %0Nd with N from 1 to 9.
std::filesystem::path numbered_file(const std::string& pattern, std::size_t number, const std::string& field = "out");

struct PathFrame {
  std::size_t number = 0;
  double time_s = 0;
  CameraOptions camera;
  int draws = 0;     ///< number of draws of this image
  FrameStats stats;  ///< of the last draw, but times and uploads are sums over all draws
};

enum class Finish {
  complete,  ///< each frame is drawn until no data is missing
  live,      ///< each frame is drawn once, as in interactive rendering
};

/// Draws until the frame is complete, or until 200 consecutive draws upload nothing while no page is loading. `draws`
/// returns the number of draws. Times and uploads in the frame's statistics are sums over all draws.
Frame draw_to_completion(FrameRenderer& renderer, const View& view, int& draws, const Progress& progress = {});

/// Draws the image of each time in order and passes it to `take`. `upload_s` limits the upload time of each draw
/// of Finish::live.
/// Errors  The errors of FrameRenderer::draw(); a UsageError names the time on the path.
void draw_path(FrameRenderer& renderer, const CameraPath& path, const View& view, const std::vector<double>& times_s,
               Finish finish, double upload_s, const std::function<void(const PathFrame&, const Picture&)>& take,
               const Progress& progress = {});

/// Returns one JSON object. Its array "frames" has the time, camera, number of draws and statistics of each frame.
std::string to_json(const std::vector<PathFrame>& frames);

}  // namespace gigabake
