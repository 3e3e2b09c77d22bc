#include "viewer/web/stream_server.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <fmt/format.h>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "viewer/live/viewer_input_json.h"
#include "viewer/pictures/image_files.h"
#include "viewer/web/external_url.h"
#include "viewer/web/http_server.h"
#include "viewer/web/image_parts.h"
#include "viewer/web/stream_sessions.h"
#include "viewer/web/web_files.h"

namespace gigabake {
namespace {

constexpr int moving_quality = 75, resting_quality = 92;
/// The time limit of a full image, and the delays of a stream's filler bytes. Without a new image, a stream sends
/// filler after first_fill_s, then every next_fill_s.
constexpr double picture_s = 60, first_fill_s = 0.25, next_fill_s = 1;
constexpr std::chrono::milliseconds bake_query_interval{50};
constexpr const char* json_type = "application/json";
constexpr const char* no_edits = "this server does not change the scene; start it with `edit`";
constexpr const char* position_expected = "expected x and y from 0 to 1, from the image's upper left corner";

HttpReply error_reply(int status, const std::string& why) {
  return {status, json_type,
          nlohmann::json{{"error", why}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

HttpReply reply_to(std::exception_ptr problem) {
  try {
    std::rethrow_exception(problem);
  } catch (const UsageError& e) {
    return error_reply(400, e.what());
  } catch (const InputError& e) {
    return error_reply(400, e.what());
  } catch (const std::exception& e) {
    return error_reply(500, e.what());
  } catch (...) {
    return error_reply(500, "failed");
  }
}

/// Parses a number from 0 to 1; nullopt for any other text.
std::optional<double> share_of(const std::string& text) {
  double share = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), share);
  if (error != std::errc() || end != text.data() + text.size() || !(share >= 0 && share <= 1)) return std::nullopt;
  return share;
}

/// Returns true for {"edits": []}, which ends a preview.
bool is_empty_list(const std::string& body) {
  const auto json = nlohmann::json::parse(body, nullptr, false);
  return json.is_object() && json.contains("edits") && json["edits"].is_array() && json["edits"].empty();
}

/// Returns true for {"undo": true}.
bool is_undo(const std::string& body) {
  const auto json = nlohmann::json::parse(body, nullptr, false);
  return json.is_object() && json.size() == 1 && json.contains("undo") && json["undo"] == true;
}

HttpReply page_part(const char* type, std::string_view text) { return {200, type, std::string(text)}; }

void check_options(const StreamServer::Options& o) {
  if (o.port < 0 || o.port > 65535) throw UsageError("port", "expected 1 to 65535, or 0 for any free port");
  if (!is_token(o.token)) throw UsageError("token", "expected letters, digits, - and _ only");
  if (o.token.size() < StreamServer::min_token_length && !(o.token.empty() && !StreamServer::is_public(o)))
    throw UsageError("token", fmt::format("expected at least {} letters or digits", StreamServer::min_token_length));
}

/// A stream of one viewer's images, as parts that replace each other.
class PictureStream : public HttpStream {
 public:
  PictureStream(LiveScene& scene, StreamSessions& sessions, std::string key, LiveScene::ViewerId viewer)
      : scene_(scene), sessions_(sessions), key_(std::move(key)), viewer_(viewer) {
    stream_ = sessions_.begin_stream(key_);
  }
  ~PictureStream() override { sessions_.end_stream(key_, stream_); }
  PictureStream(const PictureStream&) = delete;
  PictureStream& operator=(const PictureStream&) = delete;

  std::optional<std::string> next() override {
    if (!sessions_.is_streaming(key_, stream_)) return std::nullopt;
    const auto frame = scene_.frame_after(viewer_, number_, is_filling_ ? next_fill_s : first_fill_s);
    is_filling_ = !frame;
    if (!frame) return parts_.fill();
    number_ = frame->number;
    return parts_.add(encode_jpeg(frame->frame.picture, frame->full ? resting_quality : moving_quality));
  }

 private:
  LiveScene& scene_;
  StreamSessions& sessions_;
  const std::string key_;
  const LiveScene::ViewerId viewer_;
  std::uint64_t stream_ = 0, number_ = 0;
  ImageParts parts_;
  bool is_filling_ = false;
};

}  // namespace

struct StreamServer::State {
  using ViewerId = LiveScene::ViewerId;

  LiveScene& scene;
  const Options options;
  const bool local;
  const ExternalUrl external;
  StreamSessions sessions;

  std::mutex bake_mutex;  ///< guards the three members below
  std::string bake = "null";
  bool is_bake_queried = false;
  std::chrono::steady_clock::time_point bake_queried_at{};

  std::atomic<bool> is_editing = false;

  HttpServer http;  ///< last, because it calls the members above

  State(LiveScene& s, const Options& o)
      : scene(s),
        options(o),
        local(is_loopback(o.bind)),
        external(parse_external_url(o.external_url)),
        sessions(s),
        http(o.bind, o.port, handlers(), o.limits) {}

  HttpServer::Handlers handlers() {
    HttpServer::Handlers out;
    out.refuse = [this](const HttpRequest& request) { return refuse(request); };
    out.answer = [this](const HttpRequest& request) { return answer(request); };
    out.failed = reply_to;
    out.headers = {{"Cache-Control", "no-store, no-transform"},
                   {"X-Content-Type-Options", "nosniff"},
                   {"Referrer-Policy", "no-referrer"},
                   {"Content-Security-Policy", "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'"}};
    return out;
  }

  std::string cookie_name() const { return fmt::format("gigabake_{}", http.port()); }

  bool has_token(const HttpRequest& request) const {
    if (options.token.empty()) return true;
    const std::string_view bearer = request.authorization;
    const std::string_view given = bearer.starts_with("Bearer ") ? bearer.substr(7) : "";
    // All three tokens are always compared, so that the time does not depend on the results.
    const bool by_header = equal_in_constant_time(options.token, given);
    const bool by_query = equal_in_constant_time(options.token, request.argument("token"));
    const bool by_cookie = equal_in_constant_time(options.token, cookie(request.cookies, cookie_name()));
    return by_header || by_query || by_cookie;
  }

  std::optional<HttpReply> refuse(const HttpRequest& request) const {
    if (const auto refusal = refusal_of(request.head, local, external))
      return error_reply(refusal->status, refusal->why);
    if (!has_token(request))
      return error_reply(401, "expected the token: open the address that the server has printed");
    return std::nullopt;
  }

  HttpAnswer answer(const HttpRequest& request) {
    struct Route {
      const char* path;
      bool is_post;
      HttpAnswer (State::*handle)(const HttpRequest&);
    };
    static constexpr Route routes[] = {
        {"/", false, &State::page},
        {"/viewer.js", false, &State::script},
        {"/bake.js", false, &State::bake_script},
        {"/edit.js", false, &State::edit_script},
        {"/viewer.css", false, &State::style},
        {"/bake", false, &State::get_bake},
        {"/viewers", true, &State::open},
        {"/state", false, &State::for_viewer<&State::get_state>},
        {"/stream", false, &State::for_viewer<&State::stream>},
        {"/picture.png", false, &State::for_viewer<&State::picture>},
        {"/point", false, &State::for_viewer<&State::get_point>},
        {"/cell", false, &State::for_viewer<&State::get_cell>},
        {"/steer", true, &State::for_viewer<&State::steer>},
        {"/preview", true, &State::for_viewer<&State::preview>},
        {"/edit", true, &State::for_viewer<&State::edit>},
    };
    const bool is_post = request.head.method == "POST";
    const std::string_view path = without_external_path(request.path, external);
    const auto found = std::find_if(std::begin(routes), std::end(routes),
                                    [&](const Route& route) { return route.path == path && route.is_post == is_post; });
    return found == std::end(routes) ? error_reply(404, "there is no such page") : (this->*found->handle)(request);
  }

  HttpAnswer page(const HttpRequest&) {
    HttpReply reply = page_part("text/html; charset=utf-8", web_page);
    // The cookie authorizes the page's script, images and input. Its path is the path of the page, also behind a proxy.
    if (!options.token.empty())
      reply.headers.emplace_back("Set-Cookie",
                                 fmt::format("{}={}; HttpOnly; SameSite=Strict", cookie_name(), options.token));
    return reply;
  }

  HttpAnswer script(const HttpRequest&) { return page_part("text/javascript; charset=utf-8", web_script); }
  HttpAnswer bake_script(const HttpRequest&) { return page_part("text/javascript; charset=utf-8", web_bake_script); }
  HttpAnswer edit_script(const HttpRequest&) { return page_part("text/javascript; charset=utf-8", web_edit_script); }
  HttpAnswer style(const HttpRequest&) { return page_part("text/css; charset=utf-8", web_style); }

  /// Queries the bake status at most every 50 ms and by one thread at a time. Other requests get the previous status.
  HttpAnswer get_bake(const HttpRequest&) {
    const std::lock_guard lock(bake_mutex);
    if (is_bake_queried || std::chrono::steady_clock::now() - bake_queried_at < bake_query_interval)
      return HttpReply{200, json_type, bake};
    is_bake_queried = true;
    return [this] {
      const std::string told = bake_status();
      const std::lock_guard lock_again(bake_mutex);
      is_bake_queried = false;
      bake_queried_at = std::chrono::steady_clock::now();
      return HttpReply{200, json_type, bake = told};
    };
  }

  std::string bake_status() const {
    try {
      return options.bake_status();
    } catch (const std::exception& problem) {
      return nlohmann::json{{"error", problem.what()}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    }
  }

  HttpAnswer open(const HttpRequest& request) {
    const auto key = sessions.open(viewer_input_from_json(request.body));
    if (!key) return error_reply(503, "the server has its maximum number of viewers; try again later");
    const nlohmann::ordered_json told{{"viewer", *key},
                                      {"modes", names_of<ViewMode>()},
                                      {"styles", names_of<CameraController::Style>()},
                                      {"may_edit", scene.may_edit()}};
    return HttpReply{201, json_type, told.dump()};
  }

  template <HttpAnswer (State::*handle)(const HttpRequest&, ViewerId)>
  HttpAnswer for_viewer(const HttpRequest& request) {
    const auto viewer = sessions.touch(request.argument("viewer"));
    if (viewer) return (this->*handle)(request, *viewer);
    return error_reply(404, "expected viewer=KEY from POST /viewers; this viewer is unknown, or has left");
  }

  HttpAnswer get_state(const HttpRequest&, ViewerId viewer) {
    const auto state = scene.state(viewer);
    const auto frame = scene.frame_after(viewer, 0, 0);
    if (!state) return error_reply(404, "the viewer has left");
    return HttpReply{200, json_type, to_json(*state, frame.get())};
  }

  /// Returns the scene point that a pixel of the last frame shows.
  HttpAnswer get_point(const HttpRequest& request, ViewerId viewer) {
    const auto right = share_of(request.argument("x")), down = share_of(request.argument("y"));
    if (!right || !down) return error_reply(400, position_expected);
    const auto frame = scene.frame_after(viewer, 0, 0);
    if (!frame) return error_reply(404, "there is no image yet");
    return HttpReply{200, json_type, to_json(picked_point(frame->frame.picture, frame->rays, *right, *down))};
  }

  /// Returns the facts of the watched cell at a pixel of the last frame.
  HttpAnswer get_cell(const HttpRequest& request, ViewerId viewer) {
    const auto right = share_of(request.argument("x")), down = share_of(request.argument("y"));
    if (!right || !down) return error_reply(400, position_expected);
    return [this, viewer, right = *right, down = *down] {
      return HttpReply{200, json_type, to_json(scene.facts_at(viewer, right, down))};
    };
  }

  HttpAnswer steer(const HttpRequest& request, ViewerId viewer) {
    scene.steer(viewer, viewer_input_from_json(request.body));
    return get_state(request, viewer);
  }

  /// Shows a preview of the edits in the body to this viewer; ends it if the list is empty.
  HttpAnswer preview(const HttpRequest& request, ViewerId viewer) {
    if (!scene.may_edit()) return error_reply(403, no_edits);
    return [this, viewer, edits = is_empty_list(request.body) ? std::string() : request.body] {
      if (!scene.preview(viewer, edits)) return error_reply(404, "there is no image yet");
      return HttpReply{200, json_type, "{}"};
    };
  }

  /// Applies the edits in the body to the scene, or removes the last edit. One edit at a time.
  HttpAnswer edit(const HttpRequest& request, ViewerId viewer) {
    if (!scene.may_edit()) return error_reply(403, no_edits);
    if (is_editing.exchange(true)) return error_reply(409, "another viewer's edit is being applied; try again");
    return [this, viewer, edits = is_undo(request.body) ? std::string() : request.body,
            over = std::shared_ptr<void>(nullptr, [this](void*) { is_editing = false; })]() mutable {
      const std::shared_ptr<void> until_reply = std::move(over);
      scene.edit(viewer, edits);
      return HttpReply{200, json_type, "{}"};
    };
  }

  HttpAnswer stream(const HttpRequest& request, ViewerId viewer) {
    return HttpStreamReply{"multipart/x-mixed-replace; boundary=frame",
                           std::make_shared<PictureStream>(scene, sessions, request.argument("viewer"), viewer),
                           {{"X-Accel-Buffering", "no"}}};
  }

  HttpAnswer picture(const HttpRequest& request, ViewerId viewer) {
    const std::string key = request.argument("viewer");
    if (!sessions.begin_picture(key))
      return error_reply(429, "images of this viewer are already being sent; wait for them");
    return [this, viewer, over = std::shared_ptr<void>(nullptr, [this, key](void*) { sessions.end_picture(key); })] {
      const auto frame = scene.full_frame(viewer, picture_s);
      if (!frame) return error_reply(504, "the image is not complete yet; do not move the camera and try again");
      HttpReply reply{200, "image/png", encode_png(frame->clean_picture())};
      reply.headers.emplace_back("Content-Disposition", "attachment; filename=\"gigabake.png\"");
      return reply;
    };
  }
};

StreamServer::StreamServer(LiveScene& scene, const Options& options) {
  check_options(options);
  state_ = std::make_unique<State>(scene, options);
}

StreamServer::~StreamServer() { stop(); }

int StreamServer::port() const { return state_->http.port(); }

std::string StreamServer::url() const {
  const std::string query = state_->options.token.empty() ? "" : "?token=" + state_->options.token;
  const ExternalUrl& external = state_->external;
  if (!external.host.empty()) return external.origin + external.path + query;
  const std::string reachable = reachable_host(state_->options.bind);
  const std::string host = reachable.find(':') == std::string::npos ? reachable : "[" + reachable + "]";
  return fmt::format("http://{}:{}/{}", host, port(), query);
}

bool StreamServer::is_public(const Options& options) {
  const ExternalUrl external = parse_external_url(options.external_url);
  return !is_loopback(options.bind) || !(external.host.empty() || is_loopback(external.host));
}

void StreamServer::serve() { state_->http.serve(); }

void StreamServer::stop() {
  state_->scene.stop();
  state_->http.stop();
}

}  // namespace gigabake
