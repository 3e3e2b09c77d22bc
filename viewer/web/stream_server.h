/// A scene in a browser: the page, the pictures and the steering over HTTP (docs/viewer.md).
///
/// Each page has a camera of its own. Whatever a client sends is answered with a status and one line of JSON; nothing
/// that it sends or leaves unread keeps others waiting (viewer/web/http_server.h).
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "viewer/live/live_scene.h"
#include "viewer/web/http_server.h"

namespace gigabake {

class StreamServer {
 public:
  struct Options {
    std::string bind = "127.0.0.1";
    int port = 8080;    ///< 0: any that is free
    std::string token;  ///< empty: none is asked for
    /// Under which a proxy shows this server (viewer/web/external_url.h); empty: no proxy.
    std::string external_url;
    /// One JSON value about the bake that writes the scene; asked at most once a second, from any thread.
    std::function<std::string()> bake_status = [] { return std::string("null"); };
    HttpServer::Limits limits;
  };
  static constexpr std::size_t least_token = 16;

  /// Holds the port from now on; borrows the scene.
  /// Errors  UsageError: reachable beyond this machine without a token of least_token letters or digits, an external
  ///         URL that is none. InputError: the address cannot be bound.
  StreamServer(LiveScene& scene, const Options& options);
  ~StreamServer();

  int port() const;
  /// With the token, for people to open: the proxy's if there is one.
  std::string url() const;
  /// True if other machines can open url(): then a token is needed.
  static bool is_public(const Options& options);
  /// Returns after stop(), which any thread may call.
  void serve();
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
