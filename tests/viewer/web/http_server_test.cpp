#include "viewer/web/http_server.h"

#include <fstream>
#include <future>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "core/base/error.h"
#include "http_client.h"
#include "viewer/web/waiting_clients.h"

namespace gigabake {
namespace {

using namespace std::chrono_literals;

const std::string good_head = "GET / HTTP/1.1\r\nHost: localhost\r\n";

std::vector<std::unique_ptr<HttpClient>> clients(int port, int count, const std::string& say) {
  std::vector<std::unique_ptr<HttpClient>> out;
  for (int i = 0; i < count; ++i) {
    out.push_back(std::make_unique<HttpClient>(port));
    out.back()->send(say);
  }
  return out;
}

/// A server on a free port during the lifetime of this object. It answers "fine" to unhandled requests.
class HttpServed {
 public:
  explicit HttpServed(const HttpServer::Limits& limits = {}, std::function<HttpAnswer(const HttpRequest&)> handle = {})
      : server_("127.0.0.1", 0, handlers(std::move(handle)), limits), thread_([this] { server_.serve(); }) {}
  ~HttpServed() {
    server_.stop();
    thread_.join();
  }
  int port() const { return server_.port(); }
  int status() { return status_of(ask(port(), "GET", "/")); }

 private:
  static HttpServer::Handlers handlers(std::function<HttpAnswer(const HttpRequest&)> handle) {
    HttpServer::Handlers out;
    out.refuse = [](const HttpRequest& request) -> std::optional<HttpReply> {
      if (const auto refusal = refusal_of(request.head, true)) return HttpReply{refusal->status, "text/plain", "no"};
      return std::nullopt;
    };
    out.answer = [does = std::move(handle)](const HttpRequest& request) -> HttpAnswer {
      if (does && request.path != "/") return does(request);
      return HttpReply{200, "text/plain", "fine"};
    };
    out.failed = [](std::exception_ptr) { return HttpReply{500, "text/plain", "failed"}; };
    return out;
  }

  HttpServer server_;
  std::thread thread_;
};

std::uint64_t resident_bytes() {
  std::uint64_t size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return resident * std::uint64_t(sysconf(_SC_PAGE_SIZE));
}

/// Sends until the server closes. Returns the number of bytes sent.
std::size_t sent_until_closed(HttpClient& client, const std::string& what, std::size_t maximum) {
  std::size_t sent = 0;
  while (sent < maximum && client.send(what)) sent += what.size();
  return sent;
}

// 2026-11-22: an unlimited number of header lines, 1.2 GB of them, was received before the token was checked.
TEST(HttpServer, EndsAHeadThatHasNoEnd) {
  HttpServed served;
  EXPECT_EQ(served.status(), 200);
  const std::uint64_t before = resident_bytes();
  const std::string line = "X-Never: " + std::string(100, 'e') + "\r\n", long_line(4096, 'a'), short_lines = "a:\r\n";
  const std::size_t maximum = std::size_t(256) << 20;
  for (const std::string& first : {good_head, std::string("GET /"), good_head + "X-Never: ", std::string()})
    for (const std::string& more : {line, long_line, short_lines}) {
      HttpClient client(served.port());
      client.send(first);
      EXPECT_LT(sent_until_closed(client, more, maximum), maximum) << first << more;
    }
  EXPECT_LT(resident_bytes(), before + (std::uint64_t(64) << 20));
  EXPECT_EQ(served.status(), 200);
}

/// 2026-11-22: endless header lines took 1.2 GB in 25 s.
TEST(HttpServer, SaysThatAHeadIsTooLong) {
  HttpServed served;
  EXPECT_EQ(status_of(ask(served.port(), "GET", "/" + std::string(40000, 'a'))), 414);
  EXPECT_EQ(status_of(ask(served.port(), "GET", "/", "X: " + std::string(40000, 'a') + "\r\n")), 431);
  std::string lines;
  for (int i = 0; i < 2000; ++i) lines += "X: 1\r\n";
  EXPECT_EQ(status_of(ask(served.port(), "GET", "/", lines)), 431);
}

/// Sends a byte at a time, so that the connection is never silent for long. Returns true if the server closed it.
bool is_closed_while_dribbling(HttpClient& client, const std::string& bytes) {
  for (int i = 0; i < 1000; ++i) {
    if (!client.send(bytes.substr(std::size_t(i) % bytes.size(), 1))) return true;
    std::this_thread::sleep_for(20ms);
  }
  return false;
}

// 2026-11-22: a client that sent a byte every few seconds occupied a thread for ever.
TEST(HttpServer, DropsWhoTakesTooLongForARequest) {
  HttpServer::Limits limits;
  limits.request_timeout = 200ms;
  HttpServed served(limits);
  HttpClient slow_head(served.port()), slow_body(served.port()), second(served.port());
  slow_head.send(good_head);
  slow_body.send(
      "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 4000\r\n\r\n");
  EXPECT_TRUE(is_closed_while_dribbling(slow_head, "X-Slow: yes\r\n"));
  EXPECT_TRUE(is_closed_while_dribbling(slow_body, "[1, 2, 3]"));
  second.send(good_head + "\r\n");  // also closed, because it had sent nothing before
  EXPECT_EQ(status_of(second.answer()), 0);
}

/// Two connected sockets: one for the server and one for its client.
struct Connection {
  int server = -1, client = -1;
  Connection() {
    int both[2] = {-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, both), 0);
    server = both[0];
    client = both[1];
  }
  ~Connection() {
    ::close(server);
    ::close(client);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  bool is_dropped() const {
    char byte = 0;
    return ::recv(client, &byte, 1, 0) == 0;
  }
};

/// 2026-11-22: 100 slow clients blocked all other clients.
TEST(WaitingClients, AreDroppedWhenTheyAreLateOrTheOldestOfTooMany) {
  const WaitingClients::Clock::time_point start{};
  WaitingClients waiting(3, 10s);
  const Connection a, b, c, d;
  waiting.expect(a.server, start);
  waiting.expect(b.server, start + 2s);
  waiting.expect(c.server, start + 4s);
  waiting.expect(a.server, start + 6s);  // a was answered and is expected again
  waiting.drop_late(start + 11s);
  EXPECT_FALSE(a.is_dropped() || b.is_dropped() || c.is_dropped());
  waiting.expect(d.server, start + 11s);
  EXPECT_TRUE(b.is_dropped());
  EXPECT_FALSE(a.is_dropped() || c.is_dropped() || d.is_dropped());
  waiting.heard(c.server);
  waiting.drop_late(start + 16s + 1ms);
  EXPECT_TRUE(a.is_dropped());
  EXPECT_FALSE(c.is_dropped() || d.is_dropped());
}

// 2026-11-22: a hundred slow clients blocked all other clients.
TEST(HttpServer, AnswersAtOnceWhileHundredsAreSlow) {
  HttpServer::Limits limits;
  limits.request_timeout = 10min;
  limits.idle_timeout_s = 600;
  HttpServed served(limits);
  const auto start = std::chrono::steady_clock::now();
  const auto silent = clients(served.port(), 150, ""), begun = clients(served.port(), 150, good_head + "X-Slow: y");
  for (int i = 0; i < 20; ++i) EXPECT_EQ(served.status(), 200);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 60s);
}

TEST(HttpServer, ClosesMoreConnectionsThanOneAddressMayHave) {
  HttpServer::Limits limits;
  limits.connections_per_address = 4;
  HttpServed served(limits);
  auto held = clients(served.port(), 4, good_head + "\r\n");
  for (const auto& client : held) EXPECT_EQ(status_of(client->answer()), 200);
  EXPECT_EQ(served.status(), 0);
  held.clear();
  while (served.status() != 200) std::this_thread::sleep_for(10ms);  // until the server has noticed
}

/// 2026-11-22: one viewer blocked the others' frames for 23 s.
TEST(HttpServer, AReplyThatTakesLongKeepsNobodyWaiting) {
  std::promise<void> done;
  const std::shared_future<void> is_done = done.get_future().share();
  HttpServer::Limits limits;
  limits.threads = 2;
  HttpServed served(limits, [is_done](const HttpRequest&) {
    return [is_done] {
      is_done.wait();
      return HttpReply{200, "text/plain", "at last"};
    };
  });
  const auto waiting = clients(served.port(), 2, "GET /slow HTTP/1.1\r\nHost: localhost\r\n\r\n");
  int third = 0;
  while (third != 503) {  // both slow requests may still be in transit
    HttpClient client(served.port());
    client.send("GET /slow HTTP/1.1\r\nHost: localhost\r\n\r\n");
    third = status_of(client.receive(12, 0.2));
  }
  EXPECT_EQ(served.status(), 200);
  done.set_value();
  EXPECT_EQ(body_of(waiting[0]->answer()) + body_of(waiting[1]->answer()), "at lastat last");
}

/// A stream that never ends, of `bytes` bytes per part. Its destructor signals that the server has released it.
class EndlessStream : public HttpStream {
 public:
  EndlessStream(std::size_t bytes, std::promise<void>& over) : bytes_(bytes), over_(over) {}
  ~EndlessStream() override { over_.set_value(); }
  std::optional<std::string> next() override {
    if (bytes_ == 0) std::this_thread::sleep_for(10ms);
    return std::string(bytes_, 'x');
  }

 private:
  const std::size_t bytes_;
  std::promise<void>& over_;
};

TEST(HttpServer, EndsStreamsOfClientsThatLeaveOrListenToNothing) {
  for (const std::size_t bytes : {std::size_t(0), std::size_t(1) << 20}) {
    std::promise<void> left, deaf;
    HttpServer::Limits limits;
    limits.idle_timeout_s = 1;
    HttpServed served(limits, [&](const HttpRequest& request) {
      return HttpStreamReply{"text/plain",
                             std::make_shared<EndlessStream>(bytes, request.path == "/left" ? left : deaf)};
    });
    HttpClient client(served.port());
    client.send("GET /deaf HTTP/1.1\r\nHost: localhost\r\n\r\n");
    {
      HttpClient leaves(served.port());
      leaves.send("GET /left HTTP/1.1\r\nHost: localhost\r\n\r\n");
      EXPECT_EQ(status_of(leaves.receive(12)), 200);
    }
    EXPECT_EQ(left.get_future().wait_for(60s), std::future_status::ready) << bytes;
    EXPECT_TRUE(bytes == 0 || deaf.get_future().wait_for(60s) == std::future_status::ready);
    EXPECT_EQ(served.status(), 200);
  }
}

TEST(HttpServer, SaysWhoeverThrows) {
  HttpServed served({}, [](const HttpRequest& request) -> HttpAnswer {
    if (request.path == "/now") throw InputError("a", "b", "c");
    return [](/* later */) -> HttpReply { throw InputError("a", "b", "c"); };
  });
  EXPECT_EQ(status_of(ask(served.port(), "GET", "/now")), 500);
  EXPECT_EQ(status_of(ask(served.port(), "GET", "/later")), 500);
}

TEST(HttpServer, LinesOfOneNameAreOneLine) {
  HttpServed served;
  EXPECT_EQ(status_of(ask(served.port(), "GET", "/", "Host: localhost\r\nHost: localhost\r\n")), 403);
}

}  // namespace
}  // namespace gigabake
