#include "viewer/web/http_body.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <exception>
#include <poll.h>

namespace gigabake {
namespace {

/// The polling interval at which a waiting producer checks whether the server stops.
constexpr std::chrono::milliseconds stop_poll_interval{100};

}  // namespace

void HttpBody::make(const std::atomic<bool>& stopping) {
  while (wait_until_taken(stopping)) {
    std::optional<std::string> bytes;
    try {
      bytes = stream_->next();
    } catch (const std::exception&) {  // the stream ends; the client's next request reports the error
    }
    publish_bytes(std::move(bytes));
  }
  publish_bytes(std::nullopt);
}

bool HttpBody::wait_until_taken(const std::atomic<bool>& stopping) {
  std::unique_lock lock(mutex_);
  while (!suspended_ && !ended_ && !gone_ && !stopping) wake_.wait_for(lock, stop_poll_interval);
  return suspended_ && !ended_ && !gone_ && !stopping;
}

/// Polls the socket itself, because libmicrohttpd does not watch suspended connections.
bool HttpBody::is_client_disconnected() const {
  pollfd look{socket_, POLLRDHUP, 0};
  return ::poll(&look, 1, 0) > 0;
}

void HttpBody::publish_bytes(std::optional<std::string> bytes) {
  const std::lock_guard lock(mutex_);
  ended_ = ended_ || !bytes || (suspended_ && is_client_disconnected());
  if (bytes && !ended_) {
    bytes_ = std::move(*bytes);
    taken_ = 0;
  }
  if (!suspended_ || (!ended_ && bytes_.size() == taken_)) return;
  suspended_ = false;
  MHD_resume_connection(connection_);
}

ssize_t HttpBody::take(char* to, std::size_t room) {
  const std::lock_guard lock(mutex_);
  if (ended_) return MHD_CONTENT_READER_END_OF_STREAM;
  const std::size_t count = std::min(room, bytes_.size() - taken_);
  if (count == 0) {
    suspended_ = true;
    MHD_suspend_connection(connection_);
    wake_.notify_all();
    return 0;
  }
  std::memcpy(to, bytes_.data() + taken_, count);
  taken_ += count;
  return ssize_t(count);
}

void HttpBody::detach() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  wake_.notify_all();
}

}  // namespace gigabake
