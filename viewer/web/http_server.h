/// An HTTP server that withstands slow, numerous or hostile clients. It wraps libmicrohttpd behind plain values.
///
/// One thread serves all connections and never blocks on a connection. The size of a request's head and the time for
/// head and body are limited before any handler runs. Connections are limited in total and per address. Only slow
/// replies and streams run on separate threads.
#pragma once

#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "viewer/web/http_guard.h"

namespace gigabake {

struct HttpRequest {
  RequestHead head;
  std::string path, authorization, cookies;
  std::map<std::string, std::string> arguments;  ///< of the query, decoded; the last value of a repeated name
  std::string body;

  /// Returns an argument's value; empty if it is absent.
  std::string argument(const std::string& name) const;
};

struct HttpReply {
  int status = 200;
  std::string type, body;
  std::vector<std::pair<std::string, std::string>> headers = {};
};

/// A slow reply, computed on a separate thread. HttpServer::Handlers::failed converts thrown exceptions to replies.
using SlowReply = std::function<HttpReply()>;

/// A response body of unknown length.
class HttpStream {
 public:
  virtual ~HttpStream() = default;
  /// Returns the next bytes to send; empty if there are none now, nullopt if the stream has ended. The server calls
  /// next() when all earlier bytes are sent, always on the same thread. The call must return within about a second.
  virtual std::optional<std::string> next() = 0;
};

struct HttpStreamReply {
  std::string type;
  std::shared_ptr<HttpStream> stream;
  std::vector<std::pair<std::string, std::string>> headers = {};
};

using HttpAnswer = std::variant<HttpReply, SlowReply, HttpStreamReply>;

class HttpServer {
 public:
  struct Limits {
    std::size_t head_bytes = 16384;             ///< limit of request line and header; beyond it status 414 or 431
    std::size_t connections = 512;              ///< limit in total; further connections wait to be accepted
    std::size_t connections_per_address = 256;  ///< limit per client address; further connections are closed at once
    std::size_t waiting = 64;                   ///< limit of incomplete requests; beyond it the oldest is closed
    std::size_t threads = 160;                  ///< limit of slow replies and streams; further ones get status 503
    std::chrono::milliseconds request_timeout{10000};  ///< time limit of a request, since connection or last answer
    int idle_timeout_s = 5;                            ///< timeout of a connection without activity
    /// The size of a socket's send buffer. It is small, because buffered data reaches a slow client too late to be
    /// useful.
    int send_buffer_bytes = 1 << 17;
  };

  /// The callbacks of the server. The thread that serves all connections calls them, so they must not block.
  struct Handlers {
    /// Checks a request before its body is read. Returns nullopt to accept the request, or a reply that closes the
    /// connection.
    std::function<std::optional<HttpReply>(const HttpRequest&)> refuse;
    std::function<HttpAnswer(const HttpRequest&)> answer;
    /// Converts an exception of `answer` or of a slow reply to a reply.
    std::function<HttpReply(std::exception_ptr)> failed;
    std::vector<std::pair<std::string, std::string>> headers;  ///< added to every reply
  };

  /// Binds the port and listens on it.
  /// Errors  InputError: the address cannot be bound.
  HttpServer(const std::string& address, int port, Handlers handlers, const Limits& limits);
  HttpServer(const std::string& address, int port, Handlers handlers)
      : HttpServer(address, port, std::move(handlers), Limits()) {}
  ~HttpServer();

  int port() const;
  /// Serves until stop(), which any thread may call. After stop(), threads of replies and streams must end without
  /// waiting.
  /// Errors  std::runtime_error: libmicrohttpd does not start.
  void serve();
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
