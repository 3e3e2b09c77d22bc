/// The buffer of a streamed response, between the thread that produces the bytes and the thread that sends them.
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

/// A buffer that a producer and a sender share. The sender suspends the connection when the buffer is empty; the
/// producer resumes the connection.
class HttpBody {
 public:
  HttpBody(MHD_Connection* connection, int socket, std::shared_ptr<HttpStream> stream)
      : connection_(connection), socket_(socket), stream_(std::move(stream)) {}

  /// Produces bytes until the stream ends, the client disconnects or `stopping` is set. Call make() once, on a separate
  /// thread.
  void make(const std::atomic<bool>& stopping);
  /// Copies up to `room` bytes and returns their number. If no bytes are ready, returns 0 and suspends the connection.
  /// At the end of the stream, returns libmicrohttpd's end code. The sender calls this function.
  ssize_t take(char* to, std::size_t room);
  /// Marks connection and socket as invalid. The sender calls this function last.
  void detach();

 private:
  bool wait_until_taken(const std::atomic<bool>& stopping);
  void publish_bytes(std::optional<std::string> bytes);
  bool is_client_disconnected() const;

  MHD_Connection* const connection_;
  const int socket_;
  const std::shared_ptr<HttpStream> stream_;

  std::mutex mutex_;  ///< guards the members below
  std::condition_variable wake_;
  std::string bytes_;
  std::size_t taken_ = 0;
  bool suspended_ = false, ended_ = false, gone_ = false;
};

}  // namespace gigabake
