/// The pictures along a camera path.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lattice/progress.h"
#include "viewer/live/camera_path.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// frames of them, evenly from the first keyframe to the last; one: the first.
std::vector<double> times_of_frames(const CameraPath& path, int frames);
/// frames_per_s of them, from the first keyframe on, up to the last.
std::vector<double> times_at_rate(const CameraPath& path, double frames_per_s);

/// "frames/%04d.png" and 7 as "frames/0007.png". option: for the message.
/// Errors  UsageError: not exactly one %d or %0Nd with N from 1 to 9.
std::filesystem::path numbered_file(const std::string& pattern, std::size_t number, const std::string& field = "out");

struct PathFrame {
  std::size_t number = 0;
  double time_s = 0;
  CameraOptions camera;
  int draws = 0;     ///< until this picture was there
  FrameStats stats;  ///< of the last draw; its times are the sums of all
};

enum class Finish {
  complete,  ///< each frame is drawn until it misses nothing
  live,      ///< each once, as a viewer would see it in passing
};

/// Draws until the frame is complete, or until many draws in a row bring nothing. Times and uploads are sums.
Frame draw_to_the_end(FrameRenderer& renderer, const View& view, int& draws, const Progress& progress = {});

/// take(frame, picture) for each time, in their order. upload_s: for each draw of Finish::live.
/// Errors  as FrameRenderer::draw(), with the time on the path.
void draw_path(FrameRenderer& renderer, const CameraPath& path, const View& view, const std::vector<double>& times_s,
               Finish finish, double upload_s, const std::function<void(const PathFrame&, const Picture&)>& take,
               const Progress& progress = {});

/// One JSON object: "frames" with the members of FrameStats for each.
std::string to_json(const std::vector<PathFrame>& frames);

}  // namespace gigabake
