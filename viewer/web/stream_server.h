/// An HTTP server that shows a scene in a browser: page, images and user input (docs/viewer.md).
///
/// Each browser page has a separate camera. Each answer is a status and one line of JSON, except for the page's files
/// and images. No client can block others by its requests or by unread replies (viewer/web/http_server.h).
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
    int port = 8080;    ///< 0: any free port
    std::string token;  ///< empty: no token is required
    /// The URL under which a proxy publishes the server (viewer/web/external_url.h); empty: no proxy.
    std::string external_url;
    /// Returns the status of the bake that writes the scene as one JSON value. Called at most every 50 ms, from any
    /// thread.
    std::function<std::string()> bake_status = [] { return std::string("null"); };
    HttpServer::Limits limits;
  };
  static constexpr std::size_t min_token_length = 16;

  /// Binds the port; borrows the scene.
  /// Errors  UsageError: an invalid port, token or external URL; no token of min_token_length characters although other
  ///         machines can reach the server. InputError: the address cannot be bound.
  StreamServer(LiveScene& scene, const Options& options);
  ~StreamServer();

  int port() const;
  /// Returns the URL for users to open, including the token. If there is a proxy, returns the proxy's URL.
  std::string url() const;
  /// Returns true if other machines can reach the server. The server then needs a token.
  static bool is_public(const Options& options);
  /// Serves until stop(), which any thread may call.
  void serve();
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
