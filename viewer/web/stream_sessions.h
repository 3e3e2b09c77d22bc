/// Which browser page has which viewer: keys nobody guesses, and an end for those that left.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "viewer/live/live_scene.h"

namespace gigabake {

/// All members may be called from any thread.
class StreamSessions {
 public:
  explicit StreamSessions(LiveScene& scene) : scene_(scene) {}

  /// first: as the page opens. Nothing where the scene takes no more viewers, even without those that left.
  std::optional<std::string> open(const Steering& first);
  /// Its viewer, which stays a while longer.
  std::optional<LiveScene::ViewerId> touch(const std::string& key);

  /// A stream of pictures begins; one that ran before is over. 0: no such key.
  std::uint64_t begin_stream(const std::string& key);
  bool is_streaming(const std::string& key, std::uint64_t stream);
  void end_stream(const std::string& key, std::uint64_t stream);

  /// A picture is made for it. False: no such key, or most_pictures are being made already.
  bool begin_picture(const std::string& key);
  void end_picture(const std::string& key);
  static constexpr int most_pictures = 2;

 private:
  using Clock = std::chrono::steady_clock;
  struct Session {
    LiveScene::ViewerId viewer;
    Clock::time_point heard;
    std::uint64_t stream = 0;  ///< the one that runs; 0: none
    int pictures = 0;          ///< being made
  };

  void drop_those_that_left();

  LiveScene& scene_;
  std::mutex mutex_;
  std::map<std::string, Session> sessions_;
  std::uint64_t streams_ = 0;
};

}  // namespace gigabake
