#include "viewer/web/http_server.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <microhttpd.h>
#include <mutex>
#include <stdexcept>
#include <sys/socket.h>

#include "viewer/web/http_body.h"
#include "viewer/web/listen_socket.h"
#include "viewer/web/reply_threads.h"
#include "viewer/web/waiting_clients.h"

namespace gigabake {
namespace {

constexpr std::size_t stream_block_bytes = 1 << 16;
const HttpReply too_busy{503, "application/json", R"({"error":"busy; try again later"})"};

using Texts = std::map<std::string, std::string>;

/// Joins header lines of equal name to one list (RFC 9110, 5.3). Two lengths or two hosts therefore become invalid
/// values.
MHD_Result add_line(void* texts, MHD_ValueKind, const char* name, std::size_t name_size, const char* value,
                    std::size_t value_size) {
  std::string key(name, name_size);
  for (char& c : key)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  std::string& line = (*static_cast<Texts*>(texts))[key];
  line += (line.empty() ? "" : ", ") + (value ? std::string(value, value_size) : "");
  return MHD_YES;
}

MHD_Result add_argument(void* texts, MHD_ValueKind, const char* name, std::size_t name_size, const char* value,
                        std::size_t value_size) {
  (*static_cast<Texts*>(texts))[std::string(name, name_size)] = value ? std::string(value, value_size) : "";
  return MHD_YES;
}

HttpRequest request_of(MHD_Connection* connection, const char* url, const char* method) {
  Texts lines;
  HttpRequest out;
  MHD_get_connection_values_n(connection, MHD_HEADER_KIND, add_line, &lines);
  MHD_get_connection_values_n(connection, MHD_GET_ARGUMENT_KIND, add_argument, &out.arguments);
  out.head = {method,
              lines["host"],
              lines["origin"],
              lines["content-type"],
              lines["content-length"],
              lines.count("transfer-encoding") != 0,
              lines.count("content-encoding") != 0};
  out.path = url;
  out.authorization = lines["authorization"];
  out.cookies = lines["cookie"];
  return out;
}

int socket_of(MHD_Connection* connection) {
  const MHD_ConnectionInfo* info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
  return info ? info->connect_fd : -1;
}

struct Destroy {
  void operator()(MHD_Response* response) const { MHD_destroy_response(response); }
};
using Response = std::unique_ptr<MHD_Response, Destroy>;

/// The state of one request, from its head to its answer.
struct Exchange {
  HttpRequest request;
  std::optional<HttpReply> made;  ///< reply of another thread; the connection is suspended until it is set
};

}  // namespace

std::string HttpRequest::argument(const std::string& name) const {
  const auto found = arguments.find(name);
  return found == arguments.end() ? "" : found->second;
}

struct HttpServer::State {
  const Handlers handlers;
  const Limits limits;
  ListenSocket listening;
  const int port = listening.port();
  WaitingClients waiting{limits.waiting, limits.request_timeout};
  ReplyThreads threads{limits.threads};
  std::mutex mutex;
  std::condition_variable wake;
  std::atomic<bool> stopping = false;

  State(const std::string& address, int wanted_port, Handlers h, const Limits& l)
      : handlers(std::move(h)), limits(l), listening(address, wanted_port) {}

  MHD_Daemon* start() {
    return MHD_start_daemon(
        MHD_USE_AUTO_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr, on_request, this,
        MHD_OPTION_LISTEN_SOCKET, MHD_socket(listening.release()), MHD_OPTION_CONNECTION_MEMORY_LIMIT,
        limits.head_bytes, MHD_OPTION_CONNECTION_LIMIT, unsigned(limits.connections),
        MHD_OPTION_PER_IP_CONNECTION_LIMIT, unsigned(limits.connections_per_address), MHD_OPTION_CONNECTION_TIMEOUT,
        unsigned(limits.idle_timeout_s), MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_NOTIFY_CONNECTION, on_connection,
        this, MHD_OPTION_NOTIFY_COMPLETED, on_answered, this, MHD_OPTION_END);
  }

  // The callbacks of libmicrohttpd. The only thread of libmicrohttpd calls them.

  static void on_connection(void* self, MHD_Connection* connection, void**, MHD_ConnectionNotificationCode what) {
    State& state = *static_cast<State*>(self);
    const int socket = socket_of(connection);
    if (what == MHD_CONNECTION_NOTIFY_CLOSED) return state.waiting.closed(socket);
    ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &state.limits.send_buffer_bytes, sizeof(int));
    state.waiting.expect(socket, WaitingClients::Clock::now());
  }

  static void on_answered(void* self, MHD_Connection* connection, void** exchange, MHD_RequestTerminationCode how) {
    delete static_cast<Exchange*>(*exchange);
    *exchange = nullptr;
    if (how == MHD_REQUEST_TERMINATED_COMPLETED_OK)
      static_cast<State*>(self)->waiting.expect(socket_of(connection), WaitingClients::Clock::now());
  }

  /// Handles the steps of a request: its head, each part of its body, and its end. After a suspension, libmicrohttpd
  /// reports the end again.
  static MHD_Result on_request(void* self, MHD_Connection* connection, const char* url, const char* method, const char*,
                               const char* part, std::size_t* part_size, void** exchange) {
    State& state = *static_cast<State*>(self);
    try {
      if (*exchange == nullptr) {
        auto* started = new Exchange{request_of(connection, url, method), std::nullopt};
        *exchange = started;
        return state.judge(connection, started->request);
      }
      Exchange& going = *static_cast<Exchange*>(*exchange);
      if (*part_size == 0) return state.answer(connection, going);
      going.request.body.append(part, *part_size);
      *part_size = 0;
      return going.request.body.size() <= max_body_bytes ? MHD_YES : MHD_NO;
    } catch (...) {  // out of memory: closes this connection
      return MHD_NO;
    }
  }

  MHD_Result judge(MHD_Connection* connection, const HttpRequest& request) {
    auto refusal = handlers.refuse(request);
    if (!refusal) return MHD_YES;
    refusal->headers.emplace_back("Connection", "close");
    return send(connection, *refusal);
  }

  MHD_Result answer(MHD_Connection* connection, Exchange& exchange) {
    waiting.heard(socket_of(connection));
    if (exchange.made) return send(connection, *exchange.made);
    HttpAnswer answer;
    try {
      answer = handlers.answer(exchange.request);
    } catch (...) {
      answer = handlers.failed(std::current_exception());
    }
    if (const auto* reply = std::get_if<HttpReply>(&answer)) return send(connection, *reply);
    if (auto* stream = std::get_if<HttpStreamReply>(&answer)) return send_stream(connection, std::move(*stream));
    make_later(connection, exchange, std::get<SlowReply>(std::move(answer)));
    return MHD_YES;
  }

  void make_later(MHD_Connection* connection, Exchange& exchange, SlowReply later) {
    MHD_suspend_connection(connection);
    const bool started = threads.start([this, connection, &exchange, make = std::move(later)] {
      try {
        exchange.made = make();
      } catch (...) {
        exchange.made = handlers.failed(std::current_exception());
      }
      MHD_resume_connection(connection);
    });
    if (started) return;
    exchange.made = too_busy;
    MHD_resume_connection(connection);
  }

  MHD_Result send(MHD_Connection* connection, const HttpReply& reply) {
    const Response response(MHD_create_response_from_buffer(reply.body.size(), const_cast<char*>(reply.body.data()),
                                                            MHD_RESPMEM_MUST_COPY));
    for (const auto& [name, value] : reply.headers)
      if (response) MHD_add_response_header(response.get(), name.c_str(), value.c_str());
    return queue(connection, response, reply.status, reply.type);
  }

  MHD_Result send_stream(MHD_Connection* connection, HttpStreamReply&& reply) {
    const auto body = std::make_shared<HttpBody>(connection, socket_of(connection), std::move(reply.stream));
    if (!threads.start([this, body] { body->make(stopping); })) return send(connection, too_busy);
    auto owner = std::make_unique<std::shared_ptr<HttpBody>>(body);
    const Response response(MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, stream_block_bytes, take_from_stream,
                                                              owner.get(), let_go_of_stream));
    if (!response) {
      body->detach();
      return MHD_NO;
    }
    owner.release();  // the response owns it now
    for (const auto& [name, value] : reply.headers)
      MHD_add_response_header(response.get(), name.c_str(), value.c_str());
    return queue(connection, response, 200, reply.type);
  }

  static ssize_t take_from_stream(void* body, std::uint64_t, char* to, std::size_t room) {
    return (*static_cast<std::shared_ptr<HttpBody>*>(body))->take(to, room);
  }

  static void let_go_of_stream(void* body) {
    const std::unique_ptr<std::shared_ptr<HttpBody>> owner(static_cast<std::shared_ptr<HttpBody>*>(body));
    (*owner)->detach();
  }

  MHD_Result queue(MHD_Connection* connection, const Response& response, int status, const std::string& type) {
    if (!response) return MHD_NO;
    MHD_add_response_header(response.get(), MHD_HTTP_HEADER_CONTENT_TYPE, type.c_str());
    for (const auto& [name, value] : handlers.headers)
      MHD_add_response_header(response.get(), name.c_str(), value.c_str());
    return MHD_queue_response(connection, unsigned(status), response.get());
  }
};

HttpServer::HttpServer(const std::string& address, int port, Handlers handlers, const Limits& limits)
    : state_(std::make_unique<State>(address, port, std::move(handlers), limits)) {}

HttpServer::~HttpServer() = default;

int HttpServer::port() const { return state_->port; }

void HttpServer::serve() {
  State& s = *state_;
  MHD_Daemon* daemon = s.start();
  if (daemon == nullptr) throw std::runtime_error("libmicrohttpd does not start: too few files, threads or memory");
  {
    std::unique_lock lock(s.mutex);
    while (!s.stopping) {
      s.wake.wait_for(lock, s.limits.request_timeout / 8);
      s.waiting.drop_late(WaitingClients::Clock::now());
    }
  }
  s.threads.finish();  // resumes all connections, which libmicrohttpd requires before it stops
  MHD_stop_daemon(daemon);
}

void HttpServer::stop() {
  const std::lock_guard lock(state_->mutex);
  state_->stopping = true;
  state_->wake.notify_all();
}

}  // namespace gigabake
