/// A stream's bytes on their way from the thread that makes them to the one that sends them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <microhttpd.h>
#include <mutex>
#include <optional>
#include <string>

#include "viewer/web/http_server.h"

namespace gigabake {

/// Where the sender has sent all, it suspends the connection; where the maker has made more, it resumes it.
class HttpBody {
 public:
  HttpBody(MHD_Connection* connection, int socket, std::shared_ptr<HttpStream> stream)
      : connection_(connection), socket_(socket), stream_(std::move(stream)) {}

  /// Makes until the stream ends, its client leaves or `stopping`. Once, on a thread of its own.
  void make(const std::atomic<bool>& stopping);
  /// The sender's: up to `room` bytes, or what libmicrohttpd wants to hear where there are none.
  ssize_t take(char* to, std::size_t room);
  /// The sender's last word: connection and socket are no more.
  void let_go();

 private:
  bool wait_until_taken(const std::atomic<bool>& stopping);
  void hand_over(std::optional<std::string> bytes);
  bool client_has_left() const;

  MHD_Connection* const connection_;
  const int socket_;
  const std::shared_ptr<HttpStream> stream_;

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable wake_;
  std::string bytes_;
  std::size_t taken_ = 0;
  bool suspended_ = false, ended_ = false, gone_ = false;
};

}  // namespace gigabake
