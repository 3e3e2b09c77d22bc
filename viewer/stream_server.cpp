#include "viewer/stream_server.h"

#include <fmt/format.h>
#include <httplib.h>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "format/error.h"
#include "viewer/http_guard.h"
#include "viewer/jpeg.h"
#include "viewer/png.h"
#include "viewer/steering_json.h"
#include "viewer/stream_sessions.h"
#include "viewer/web_files.h"

namespace gigabake {
namespace {

using httplib::Request, httplib::Response;

constexpr int moving_quality = 75, resting_quality = 92;
constexpr std::size_t connections = 96, requests_a_connection = 1000;
constexpr int patience_s = 5;  ///< with a client that neither sends nor takes
constexpr double picture_s = 60, stream_look_s = 1;
/// What is on its way to a slow client is old when it comes.
constexpr int send_buffer_bytes = 1 << 17;
constexpr const char* json_type = "application/json";
const std::string part_head = "--frame\r\nContent-Type: image/jpeg\r\n\r\n";

void answer(Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(nlohmann::json{{"error", why}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                       json_type);
}

RequestHead head_of(const Request& r) {
  return {r.method,
          r.get_header_value("Host"),
          r.get_header_value("Origin"),
          r.get_header_value("Content-Type"),
          r.get_header_value("Content-Length"),
          r.has_header("Transfer-Encoding"),
          r.has_header("Content-Encoding")};
}

/// Not SO_REUSEPORT, the library's default: two servers would share a port and its clients.
void set_socket_options(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &send_buffer_bytes, sizeof send_buffer_bytes);
}

void check_options(const StreamServer::Options& o) {
  if (o.port < 0 || o.port > 65535) throw UsageError("--port: expected 1 to 65535, or 0 for any that is free");
  if (!is_token(o.token)) throw UsageError("--token: expected letters, digits, - and _ only");
  if (o.token.size() < StreamServer::least_token && !(o.token.empty() && is_loopback(o.bind)))
    throw UsageError(fmt::format("--token: expected at least {} letters or digits", StreamServer::least_token));
}

/// One stream of a viewer's pictures, as parts that replace each other.
class PictureStream {
 public:
  PictureStream(LiveScene& scene, StreamSessions& sessions, std::string key, LiveScene::ViewerId viewer)
      : scene_(scene), sessions_(sessions), key_(std::move(key)), viewer_(viewer) {
    stream_ = sessions_.begin_stream(key_);
  }
  ~PictureStream() { sessions_.end_stream(key_, stream_); }
  PictureStream(const PictureStream&) = delete;
  PictureStream& operator=(const PictureStream&) = delete;

  /// The next picture, or nothing for a while. False: the stream is over.
  bool send(httplib::DataSink& sink) {
    if (!sessions_.is_streaming(key_, stream_)) return false;
    const auto frame = scene_.frame_after(viewer_, number_, stream_look_s);
    if (!frame) return true;
    const std::string jpeg = encode_jpeg(frame->frame.picture, frame->full ? resting_quality : moving_quality);
    // Browsers show a part when they have read the head of the next: it is sent right behind, not with the next
    // picture.
    const std::string parts = (number_ == 0 ? part_head : "") + jpeg + "\r\n" + part_head;
    number_ = frame->number;
    return sink.write(parts.data(), parts.size());
  }

 private:
  LiveScene& scene_;
  StreamSessions& sessions_;
  const std::string key_;
  const LiveScene::ViewerId viewer_;
  std::uint64_t stream_ = 0, number_ = 0;
};

}  // namespace

struct StreamServer::State {
  LiveScene& scene;
  const Options options;
  const bool local;
  StreamSessions sessions;
  httplib::Server http;
  int port = 0;

  std::mutex bake_mutex;
  std::string bake = "null";
  std::chrono::steady_clock::time_point bake_asked{};

  State(LiveScene& s, const Options& o) : scene(s), options(o), local(is_loopback(o.bind)), sessions(s) {
    set_limits();
    set_routes();
    port = options.port == 0 ? http.bind_to_any_port(options.bind)
                             : (http.bind_to_port(options.bind, options.port) ? options.port : -1);
    if (port < 0)
      throw InputError(fmt::format("{}:{}", options.bind, options.port), "",
                       "cannot listen there; is another server using it? --port 0 takes any that is free");
  }

  std::string cookie_name() const { return fmt::format("gigabake_{}", port); }

  bool has_token(const Request& request) const {
    if (options.token.empty()) return true;
    const std::string bearer = request.get_header_value("Authorization"), cookies = request.get_header_value("Cookie");
    const std::string_view given = bearer.starts_with("Bearer ") ? std::string_view(bearer).substr(7) : "";
    // Each is compared, whatever the others say.
    const bool by_header = equal_in_constant_time(options.token, given);
    const bool by_query = equal_in_constant_time(options.token, request.get_param_value("token"));
    const bool by_cookie = equal_in_constant_time(options.token, cookie(cookies, cookie_name()));
    return by_header || by_query || by_cookie;
  }

  void set_limits() {
    http.new_task_queue = [] { return new httplib::ThreadPool(connections); };
    http.set_socket_options(set_socket_options);
    http.set_tcp_nodelay(true);
    http.set_keep_alive_max_count(requests_a_connection);
    http.set_keep_alive_timeout(patience_s);
    http.set_read_timeout(patience_s);
    http.set_write_timeout(patience_s);
    http.set_payload_max_length(most_body_bytes);
    http.set_default_headers(
        {{"Cache-Control", "no-store"},
         {"X-Content-Type-Options", "nosniff"},
         {"Referrer-Policy", "no-referrer"},
         {"Content-Security-Policy", "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'"}});
  }

  void set_routes() {
    http.set_pre_routing_handler([this](const Request& request, Response& response) {
      if (const auto refusal = refusal_of(head_of(request), local)) {
        answer(response, refusal->status, refusal->why);
      } else if (!has_token(request)) {
        answer(response, 401, "expected the token: open the address that the server has printed");
      } else {
        return httplib::Server::HandlerResponse::Unhandled;
      }
      return httplib::Server::HandlerResponse::Handled;
    });
    http.set_error_handler([](const Request&, Response& response) {
      if (response.body.empty()) answer(response, response.status, "refused");
    });
    http.set_exception_handler([](const Request&, Response& response, std::exception_ptr error) {
      try {
        std::rethrow_exception(error);
      } catch (const InputError& e) {
        answer(response, 400, e.what());
      } catch (const std::exception& e) {
        answer(response, 500, e.what());
      } catch (...) {
        answer(response, 500, "failed");
      }
    });
    set_page_routes();
    set_viewer_routes();
  }

  void set_page_routes() {
    http.Get("/", [this](const Request&, Response& response) {
      // So that script, pictures and steering come with it.
      if (!options.token.empty())
        response.set_header("Set-Cookie",
                            fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/", cookie_name(), options.token));
      response.set_content(web_page.data(), web_page.size(), "text/html; charset=utf-8");
    });
    http.Get("/viewer.js", [](const Request&, Response& response) {
      response.set_content(web_script.data(), web_script.size(), "text/javascript; charset=utf-8");
    });
    http.Get("/viewer.css", [](const Request&, Response& response) {
      response.set_content(web_style.data(), web_style.size(), "text/css; charset=utf-8");
    });
    http.Get("/bake", [this](const Request&, Response& response) { response.set_content(bake_status(), json_type); });
    http.Post("/viewers", [this](const Request& request, Response& response) { open(request, response); });
  }

  void set_viewer_routes() {
    using ForViewer = void (State::*)(const Request&, Response&, LiveScene::ViewerId);
    const auto for_viewer = [this](ForViewer handle) {
      return [this, handle](const Request& request, Response& response) {
        const auto viewer = sessions.touch(request.get_param_value("viewer"));
        if (viewer) return (this->*handle)(request, response, *viewer);
        answer(response, 404, "expected viewer=KEY as POST /viewers gives it; that one is not known, or has left");
      };
    };
    http.Get("/state", for_viewer(&State::tell_state));
    http.Get("/stream", for_viewer(&State::stream));
    http.Get("/picture.png", for_viewer(&State::send_picture));
    http.Post("/steer", for_viewer(&State::steer));
  }

  std::string bake_status() {
    const std::lock_guard lock(bake_mutex);
    const auto now = std::chrono::steady_clock::now();
    if (now - bake_asked < std::chrono::seconds(1)) return bake;
    bake_asked = now;
    return bake = options.bake_status();
  }

  void open(const Request& request, Response& response) {
    const auto key = sessions.open(steering_from_json(request.body));
    if (!key) return answer(response, 503, "as many look already as this server takes; try again later");
    response.status = 201;
    response.set_content(
        nlohmann::ordered_json{{"viewer", *key}, {"modes", view_mode_names()}, {"styles", style_names()}}.dump(),
        json_type);
  }

  void tell_state(const Request&, Response& response, LiveScene::ViewerId viewer) {
    const auto state = scene.state(viewer);
    const auto frame = scene.frame_after(viewer, 0, 0);
    if (!state) return answer(response, 404, "that viewer has left");
    response.set_content(to_json(*state, frame.get()), json_type);
  }

  void steer(const Request& request, Response& response, LiveScene::ViewerId viewer) {
    scene.steer(viewer, steering_from_json(request.body));
    tell_state(request, response, viewer);
  }

  void stream(const Request& request, Response& response, LiveScene::ViewerId viewer) {
    const auto pictures = std::make_shared<PictureStream>(scene, sessions, request.get_param_value("viewer"), viewer);
    response.set_chunked_content_provider(
        "multipart/x-mixed-replace; boundary=frame",
        [pictures](std::size_t, httplib::DataSink& sink) { return pictures->send(sink); });
  }

  void send_picture(const Request&, Response& response, LiveScene::ViewerId viewer) {
    const auto frame = scene.full_frame(viewer, picture_s);
    if (!frame) return answer(response, 504, "the picture is not complete yet; hold still and try again");
    response.set_header("Content-Disposition", "attachment; filename=\"gigabake.png\"");
    response.set_content(encode_png(frame->frame.picture), "image/png");
  }
};

StreamServer::StreamServer(LiveScene& scene, const Options& options) {
  check_options(options);
  state_ = std::make_unique<State>(scene, options);
}

StreamServer::~StreamServer() { stop(); }

int StreamServer::port() const { return state_->port; }

std::string StreamServer::url() const {
  const std::string& bind = state_->options.bind;
  const std::string host = bind.find(':') == std::string::npos ? bind : "[" + bind + "]";
  const std::string& token = state_->options.token;
  return fmt::format("http://{}:{}/{}", host, state_->port, token.empty() ? "" : "?token=" + token);
}

void StreamServer::serve() { state_->http.listen_after_bind(); }

void StreamServer::stop() {
  state_->scene.stop();
  state_->http.stop();
}

}  // namespace gigabake
