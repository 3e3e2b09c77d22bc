#include "viewer/web/stream_sessions.h"

#include "viewer/web/http_guard.h"

namespace gigabake {
namespace {

/// The session timeout. An open page requests its state every half second. A reloaded page uses a new key.
constexpr std::chrono::seconds session_timeout{10};

}  // namespace

void StreamSessions::remove_expired() {
  const auto now = Clock::now();
  std::erase_if(sessions_, [&](const auto& entry) {
    const bool left =
        entry.second.stream == 0 && entry.second.pictures == 0 && now - entry.second.heard > session_timeout;
    if (left) scene_.remove_viewer(entry.second.viewer);
    return left;
  });
}

std::optional<std::string> StreamSessions::open(const ViewerInput& first) {
  const std::lock_guard lock(mutex_);
  remove_expired();
  const auto viewer = scene_.add_viewer(first);
  if (!viewer) return std::nullopt;
  const std::string key = random_key();
  sessions_[key] = {*viewer, Clock::now()};
  return key;
}

std::optional<LiveScene::ViewerId> StreamSessions::touch(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(key);
  if (found == sessions_.end()) return std::nullopt;
  found->second.heard = Clock::now();
  remove_expired();
  return found->second.viewer;
}

std::uint64_t StreamSessions::begin_stream(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(key);
  return found == sessions_.end() ? 0 : found->second.stream = ++streams_;
}

bool StreamSessions::is_streaming(const std::string& key, std::uint64_t stream) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(key);
  return found != sessions_.end() && found->second.stream == stream;
}

void StreamSessions::end_stream(const std::string& key, std::uint64_t stream) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(key);
  if (found == sessions_.end() || found->second.stream != stream) return;
  found->second.stream = 0;
  found->second.heard = Clock::now();
}

bool StreamSessions::begin_picture(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(key);
  if (found == sessions_.end() || found->second.pictures >= max_images) return false;
  ++found->second.pictures;
  return true;
}

void StreamSessions::end_picture(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(key);
  if (found == sessions_.end()) return;
  --found->second.pictures;
  found->second.heard = Clock::now();
}

}  // namespace gigabake
