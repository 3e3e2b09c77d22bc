/// The sessions of browser pages: unguessable keys, each for one viewer, and removal of pages that have left.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "viewer/live/live_scene.h"

namespace gigabake {

/// Thread-safe: any thread may call any member.
class StreamSessions {
 public:
  explicit StreamSessions(LiveScene& scene) : scene_(scene) {}

  /// Adds a viewer and returns its key. `first` is the initial input. Returns nullopt if the scene accepts no more
  /// viewers, even after the removal of viewers that have left.
  std::optional<std::string> open(const ViewerInput& first);
  /// Returns the viewer of a key and extends the viewer's session; nullopt if the key is unknown.
  std::optional<LiveScene::ViewerId> touch(const std::string& key);

  /// Begins an image stream and ends the key's previous stream. Returns the stream's number; 0 if the key is unknown.
  std::uint64_t begin_stream(const std::string& key);
  bool is_streaming(const std::string& key, std::uint64_t stream);
  void end_stream(const std::string& key, std::uint64_t stream);

  /// Begins the rendering of one image. Returns false if the key is unknown or max_images are in progress.
  bool begin_picture(const std::string& key);
  void end_picture(const std::string& key);
  static constexpr int max_images = 2;

 private:
  using Clock = std::chrono::steady_clock;
  struct Session {
    LiveScene::ViewerId viewer;
    Clock::time_point heard;
    std::uint64_t stream = 0;  ///< number of the active stream; 0: none
    int pictures = 0;          ///< number of images in progress
  };

  void remove_expired();

  LiveScene& scene_;
  std::mutex mutex_;
  std::map<std::string, Session> sessions_;
  std::uint64_t streams_ = 0;
};

}  // namespace gigabake
