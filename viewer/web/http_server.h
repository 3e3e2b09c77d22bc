/// HTTP for clients that may be slow, many or hostile: libmicrohttpd behind plain values.
///
/// One thread talks to all connections and never waits for one of them. A request's head is bounded in bytes, and head
/// and body in time, before anybody looks at them; connections are bounded in all and by address. Only what takes a
/// while to answer, and streams, have a thread each.
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
  std::map<std::string, std::string> arguments;  ///< of the query, decoded; the last of a name
  std::string body;

  /// Empty where there is none.
  std::string argument(const std::string& name) const;
};

struct HttpReply {
  int status = 200;
  std::string type, body;
  std::vector<std::pair<std::string, std::string>> headers = {};
};

/// A reply that takes a while: called on a thread of its own. What it throws, HttpServer::Handlers::failed answers.
using HttpLater = std::function<HttpReply()>;

/// A body without an end.
class HttpStream {
 public:
  virtual ~HttpStream() = default;
  /// What to send next, asked for when all before is on its way; empty: nothing for now. Nothing: it has ended. Returns
  /// within a second or so; called by one thread of its own.
  virtual std::optional<std::string> next() = 0;
};

struct HttpStreamReply {
  std::string type;
  std::shared_ptr<HttpStream> stream;
  std::vector<std::pair<std::string, std::string>> headers = {};
};

using HttpAnswer = std::variant<HttpReply, HttpLater, HttpStreamReply>;

class HttpServer {
 public:
  struct Limits {
    std::size_t head_bytes = 16384;             ///< request line and header lines; what is longer gets 414 or 431
    std::size_t connections = 512;              ///< in all; more wait to be accepted
    std::size_t an_address = 256;               ///< of them from one address; more are closed at once
    std::size_t waiting = 64;                   ///< of them without a whole request: the oldest is closed for a new one
    std::size_t threads = 160;                  ///< of slow replies and streams; beyond them 503
    std::chrono::milliseconds patience{10000};  ///< from a connection or its last answer to the end of its request
    int silence_s = 5;                          ///< with a client that takes nothing of its answer
    /// What is on its way to a slow client is old when it comes.
    int send_buffer_bytes = 1 << 17;
  };

  /// Called by the thread that talks to all: they return at once.
  struct Handlers {
    /// Judges a request before its body is read. Nothing: go on. A reply closes the connection.
    std::function<std::optional<HttpReply>(const HttpRequest&)> refuse;
    std::function<HttpAnswer(const HttpRequest&)> answer;
    /// The reply to what `answer`, or a later reply, threw.
    std::function<HttpReply(std::exception_ptr)> failed;
    std::vector<std::pair<std::string, std::string>> headers;  ///< of every reply
  };

  /// Holds the port from now on.
  /// Errors  InputError: it cannot be listened on.
  HttpServer(const std::string& address, int port, Handlers handlers, const Limits& limits);
  HttpServer(const std::string& address, int port, Handlers handlers)
      : HttpServer(address, port, std::move(handlers), Limits()) {}
  ~HttpServer();

  int port() const;
  /// Returns after stop(), which any thread may call. Replies and streams on threads must not wait then.
  /// Errors  std::runtime_error: libmicrohttpd does not start.
  void serve();
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
