#include "viewer/web/stream_server.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <thread>

#include "core/base/error.h"
#include "format/source/mesh.h"
#include "http_client.h"
#include "tests/format/shard/made_shard.h"
#include "tests/viewer/stored_hill.h"
#include "viewer/web/stream_sessions.h"

namespace gigabake {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

const std::string token = "sesame-sesame-sesame";

/// A server on a free port during the lifetime of this object.
class Served {
 public:
  explicit Served(const StreamServer::Options& options = {}, bool with_scene = true) {
    if (with_scene) write_hill(folder_ / "scene.xml");
    LiveScene::Options live;
    live.renderer.threads = 1;
    live.camera.width = 96;
    live.camera.height = 64;
    live.max_viewers = 4;
    scene_.emplace(folder_ / "scene.xml", live);
    StreamServer::Options any = options;
    any.port = 0;
    server_.emplace(*scene_, any);
    thread_ = std::thread([this] { server_->serve(); });
    status_of(ask(port(), "GET", "/"));  // an answer shows that it runs
  }
  ~Served() {
    server_->stop();
    thread_.join();
  }

  int port() const { return server_->port(); }
  std::string url() const { return server_->url(); }
  std::filesystem::path scene_xml() const { return folder_ / "scene.xml"; }

  std::string viewer() { return json::parse(body_of(ask(port(), "POST", "/viewers", "", "{}"))).at("viewer"); }
  json steer(const std::string& key, const std::string& body) {
    return json::parse(body_of(ask(port(), "POST", "/steer?viewer=" + key, "", body)));
  }
  int status(const std::string& method, const std::string& target, const std::string& head = "",
             const std::string& body = "") {
    return status_of(ask(port(), method, target, head, body));
  }

 private:
  made::TempFolder folder_;
  std::optional<LiveScene> scene_;
  std::optional<StreamServer> server_;
  std::thread thread_;
};

Image picture_of(const std::string& answer) {
  const std::string body = body_of(answer);
  return decode_image({"picture", {body.begin(), body.end()}});
}

TEST(StreamServer, GivesThePageAndItsParts) {
  Served served;
  EXPECT_THAT(body_of(ask(served.port(), "GET", "/")), StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(body_of(ask(served.port(), "GET", "/viewer.js")), HasSubstr("steer"));
  EXPECT_THAT(body_of(ask(served.port(), "GET", "/viewer.css")), HasSubstr("#picture"));
  EXPECT_EQ(served.status("GET", "/nothing"), 404);
}

TEST(StreamServer, EachViewerSteersACameraOfItsOwn) {
  Served served;
  const std::string first = served.viewer(), second = served.viewer();
  const Image before = picture_of(ask(served.port(), "GET", "/picture.png?viewer=" + first));
  EXPECT_EQ(before.width, 96);
  const json moved = served.steer(second, R"({"turn": [0.25, 0.05], "mode": "albedo"})");
  const json still = served.steer(first, "{}");
  EXPECT_EQ(moved["mode"], "albedo");
  EXPECT_EQ(still["mode"], "lit");
  EXPECT_NE(moved["eye"], still["eye"]);
  EXPECT_NE(picture_of(ask(served.port(), "GET", "/picture.png?viewer=" + second)).rgba, before.rgba);
  EXPECT_EQ(picture_of(ask(served.port(), "GET", "/picture.png?viewer=" + first)).rgba, before.rgba);
}

TEST(StreamServer, SaysWhatLiesAtAPixel) {
  Served served;
  const std::string key = served.viewer();
  picture_of(ask(served.port(), "GET", "/picture.png?viewer=" + key));
  const auto at = [&](const std::string& pixel) {
    return json::parse(body_of(ask(served.port(), "GET", "/point?viewer=" + key + pixel)));
  };
  const json state = served.steer(key, "{}"), met = at("&x=.5&y=.5")["point"];
  std::array<double, 3> eye = state["eye"], target = state["target"], there = met["scene"];
  const double distance = met["distance_m"];
  double length = 0, off = 0;
  for (std::size_t a = 0; a < 3; ++a) length += (target[a] - eye[a]) * (target[a] - eye[a]);
  for (std::size_t a = 0; a < 3; ++a)
    off = std::max(off, std::fabs(eye[a] + (target[a] - eye[a]) / std::sqrt(length) * distance - there[a]));
  EXPECT_LT(off, 0.02 * distance);  // the middle lies between two pixels
  EXPECT_GT(there[0], 0);
  EXPECT_LT(there[0], 32);
  EXPECT_FALSE(met.contains("lat_lon_height"));  // the hill has no place on the earth
  EXPECT_EQ(at("&x=0&y=0")["point"], nullptr);
  for (const std::string wrong : {"", "&x=.5", "&x=2&y=0", "&x=nan&y=0", "&x=-0.1&y=.5", "&x=.5m&y=.5"})
    EXPECT_EQ(served.status("GET", "/point?viewer=" + key + wrong), 400) << wrong;
}

TEST(StreamServer, StreamsJpegsThatReplaceEachOther) {
  Served served;
  const std::string key = served.viewer();
  HttpClient client(served.port());
  client.send("GET /stream?viewer=" + key + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  // The head of the next part follows each image at once, because browsers show an image only then.
  const std::string next = "\r\n--frame\r\nContent-Type: image/jpeg\r\n\r\n\r\n";
  const std::string start = client.receive_until(next);
  EXPECT_THAT(start, HasSubstr("multipart/x-mixed-replace; boundary=frame"));
  EXPECT_TRUE(start.ends_with(next));
  served.steer(key, R"({"turn": [0.1, 0]})");
  EXPECT_TRUE(client.receive_until(next).ends_with(next));
}

TEST(StreamServer, NamesWhatIsWrongWithASteering) {
  Served served;
  const std::string key = served.viewer(), target = "/steer?viewer=" + key;
  const std::pair<const char*, const char*> wrong[] = {
      {"", "not valid JSON"},
      {"{", "not valid JSON"},
      {"[]", "expected a JSON object"},
      {R"({"turn": [NaN, 0]})", "not valid JSON"},
      {R"({"turn": [1e999, 0]})", "not valid JSON"},
      {R"({"turn": 1})", "turn: expected an array of 2 numbers"},
      {R"({"turn": [1e30, 0]})", "from -100 to 100"},
      {R"({"zoom": "near"})", "zoom: expected a number"},
      {R"({"mode": "x-ray"})", "mode: expected one of lit"},
      {R"({"fly": true})", "unknown member"},
      {R"({"pose": [1, 2, 3]})", "pose: expected an array of 6"},
  };
  for (const auto& [body, why] : wrong) {
    const std::string answer = ask(served.port(), "POST", target, "", body);
    EXPECT_EQ(status_of(answer), 400) << body;
    EXPECT_THAT(body_of(answer), HasSubstr(why)) << body;
  }
  std::string nested;
  for (int i = 0; i < 2000; ++i) nested += "[";
  EXPECT_EQ(served.status("POST", target, "", nested), 400);
  EXPECT_EQ(served.steer(key, "{}")["style"], "orbit");
}

TEST(StreamServer, AnswersStrangersWithAStatus) {
  Served served;
  EXPECT_EQ(served.status("POST", "/steer?viewer=nobody", "", "{}"), 404);
  EXPECT_EQ(served.status("GET", "/stream"), 404);
  EXPECT_EQ(served.status("GET", "/", "Host: evil.example\r\n"), 403);
  EXPECT_EQ(served.status("POST", "/viewers", "Origin: http://evil.example\r\n", "{}"), 403);
  EXPECT_EQ(served.status("POST", "/viewers", "Content-Type: text/plain\r\n", "{}"), 415);
  EXPECT_EQ(served.status("DELETE", "/viewers"), 405);
  EXPECT_EQ(served.status("POST", "/viewers", "Content-Length: 99999999999\r\n", "{}"), 413);
  EXPECT_EQ(served.status("POST", "/viewers", "Transfer-Encoding: chunked\r\n", "ffffffff\r\n"), 411);
  EXPECT_EQ(served.status("GET", "/" + std::string(20000, 'a')), 414);
  EXPECT_EQ(served.status("GET", "/"), 200);
}

// 2026-11-22: each request had a separate thread, without a limit.
TEST(StreamServer, MakesFewPicturesOfAViewerAtATime) {
  Served served({}, false);  // without a scene the requests wait
  const std::string key = served.viewer(), target = "/picture.png?viewer=" + key;
  std::vector<std::unique_ptr<HttpClient>> waiting;
  for (int i = 0; i < StreamSessions::max_images; ++i) {
    waiting.push_back(std::make_unique<HttpClient>(served.port()));
    waiting.back()->send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  EXPECT_EQ(served.status("GET", "/state?viewer=" + key), 200);  // by now all of these requests have been received
  EXPECT_EQ(served.status("GET", target), 429);
}

TEST(StreamServer, TakesNoMoreViewersThanTheScene) {
  Served served;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(served.status("POST", "/viewers", "", "{}"), 201);
  EXPECT_EQ(served.status("POST", "/viewers", "", "{}"), 503);
}

TEST(StreamServer, AsksForTheTokenInAnyOfThreePlaces) {
  StreamServer::Options options;
  options.token = token;
  Served served(options);
  EXPECT_THAT(served.url(), testing::EndsWith("/?token=" + token));
  EXPECT_EQ(served.status("GET", "/"), 401);
  EXPECT_EQ(served.status("GET", "/?token=sesame-sesame-sesamf"), 401);
  EXPECT_EQ(served.status("GET", "/viewer.js"), 401);
  EXPECT_EQ(served.status("POST", "/viewers", "", "{}"), 401);
  EXPECT_EQ(served.status("GET", "/", "Authorization: Bearer " + token + "\r\n"), 200);
  const std::string page = ask(served.port(), "GET", "/?token=" + token);
  EXPECT_EQ(status_of(page), 200);
  const std::string name = "gigabake_" + std::to_string(served.port());
  EXPECT_THAT(page, HasSubstr("Set-Cookie: " + name + "=" + token + "; HttpOnly; SameSite=Strict"));
  EXPECT_EQ(served.status("POST", "/viewers", "Cookie: a=b; " + name + "=" + token + "\r\n", "{}"), 201);
  EXPECT_EQ(served.status("POST", "/viewers", "Cookie: " + name + "=\r\n", "{}"), 401);
}

TEST(StreamServer, RefusesToStandOpenToOtherMachines) {
  LiveScene scene("nowhere/scene.xml", {});
  const auto start = [&](const std::string& bind, const std::string& secret) {
    StreamServer::Options options;
    options.bind = bind;
    options.token = secret;
    options.port = 0;
    const StreamServer server(scene, options);
  };
  EXPECT_THROW(start("0.0.0.0", ""), UsageError);
  EXPECT_THROW(start("0.0.0.0", "short"), UsageError);
  EXPECT_THROW(start("127.0.0.1", "short"), UsageError);
  EXPECT_THROW(start("127.0.0.1", "white space in a token"), UsageError);
  EXPECT_THROW(start("no.such.host.invalid", token), InputError);
  EXPECT_NO_THROW(start("0.0.0.0", token));
}

TEST(StreamServer, TwoServersDoNotShareAPort) {
  Served served;
  LiveScene scene("nowhere/scene.xml", {});
  StreamServer::Options options;
  options.port = served.port();
  EXPECT_THROW(StreamServer(scene, options), InputError);
}

TEST(StreamServer, ShowsHowTheBakeGoesUntilThereIsAScene) {
  StreamServer::Options options;
  options.bake_status = [] { return std::string(R"({"line": "3/7 cells"})"); };
  Served served(options, false);
  const std::string key = served.viewer();
  EXPECT_EQ(body_of(ask(served.port(), "GET", "/bake")), R"({"line": "3/7 cells"})");
  EXPECT_EQ(served.steer(key, R"({"size": [64, 48]})")["scene"], false);
  write_hill(served.scene_xml());
  EXPECT_EQ(picture_of(ask(served.port(), "GET", "/picture.png?viewer=" + key)).width, 64);
}

TEST(StreamServer, AnswersOthersWhileManySayNothingOrListenToNothing) {
  Served served;
  const std::string key = served.viewer();
  std::vector<std::unique_ptr<HttpClient>> idle;
  for (int i = 0; i < 60; ++i) {
    idle.push_back(std::make_unique<HttpClient>(served.port()));
    if (i % 3 == 1) idle.back()->send("GET / HT");
    if (i % 3 == 2)
      idle.back()->send(
          "POST /viewers HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\nContent-Type: "
          "application/json\r\n\r\n{");
  }
  HttpClient deaf(served.port());
  deaf.send("GET /stream?viewer=" + key + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(served.status("GET", "/picture.png?viewer=" + key), 200);  // the scene has been loaded
  for (int i = 0; i < 20; ++i) EXPECT_EQ(served.steer(key, R"({"turn": [0.1, 0]})")["scene"], true);
  EXPECT_EQ(served.status("GET", "/"), 200);
}

/// Returns the viewer's state as soon as it satisfies `good`, or the last state after a minute.
json wait_for(Served& served, const std::string& key, const std::function<bool(const json&)>& good) {
  json state;
  for (int i = 0; i < 6000; ++i) {
    state = served.steer(key, "{}");
    if (!state["frame"].is_null() && good(state)) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return state;
}

// 2026-11-22: one viewer of 4096 x 4096 blocked the others' frames for 23 s.
TEST(StreamServer, AViewerOfAVeryLargePictureLeavesTurnsToOthers) {
  Served served;
  const std::string large = served.viewer();
  served.steer(large, R"({"size": [4096, 4096]})");
  const json under_way = wait_for(served, large, [](const json& s) { return s["frame"]["size"][0] == 4096; });
  ASSERT_EQ(under_way["frame"]["size"], json({4096, 4096}));
  const std::string small = served.viewer();  // created here because a viewer that sends nothing for ten seconds
                                              // expires
  for (int i = 0; i < 3; ++i) {
    served.steer(large, "{}");
    const json moved = served.steer(small, R"({"turn": [0.1, 0]})");
    const std::uint64_t before = moved["frame"].is_null() ? 0 : moved["frame"]["number"].get<std::uint64_t>();
    const json seen = wait_for(served, small, [&](const json& s) { return s["frame"]["number"] > before; });
    EXPECT_GT(seen["frame"]["number"], before);
  }
  EXPECT_FALSE(served.steer(large, "{}")["resting"]) << "others waited until it was done";
}

TEST(StreamServer, SurvivesNoise) {
  Served served;
  const std::string key = served.viewer();
  // 2026-11-25: on a busy machine the random bytes of this test ended before the scene was loaded.
  ASSERT_EQ(wait_for(served, key, [](const json& state) { return state["scene"] == true; })["scene"], true);
  const std::string good = "POST /steer?viewer=" + key +
                           " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: "
                           "21\r\n\r\n{\"turn\": [0.25, 0.5]}";
  for (unsigned seed = 1; seed <= 150; ++seed) {
    std::mt19937_64 random(seed);
    std::string bytes = good;
    for (unsigned k = 0; k < 1 + seed % 6; ++k) bytes[random() % bytes.size()] = char(random());
    HttpClient client(served.port());
    client.send(bytes.substr(0, seed % 5 == 0 ? random() % bytes.size() : bytes.size()));
    client.receive(1 << 16, seed % 10 == 0 ? 0.05 : 0);
  }
  EXPECT_EQ(served.steer(key, R"({"home": true})")["scene"], true);
}

}  // namespace
}  // namespace gigabake
