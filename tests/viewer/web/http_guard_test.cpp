#include "viewer/web/http_guard.h"

#include <gtest/gtest.h>
#include <set>

#include "core/base/error.h"
#include "viewer/web/external_url.h"

namespace gigabake {
namespace {

RequestHead get(const std::string& host) { return {"GET", host, "", "", "", false, false}; }

RequestHead post(const std::string& length) {
  return {"POST", "localhost:8080", "", "application/json", length, false, false};
}

int guard_status(const RequestHead& head, bool local = true) {
  const auto refusal = refusal_of(head, local);
  return refusal ? refusal->status : 200;
}

TEST(HttpGuard, KnowsWhatNoOtherMachineCanReach) {
  for (const char* host : {"localhost", "LocalHost", "127.0.0.1", "127.1.2.3", "::1"})
    EXPECT_TRUE(is_loopback(host)) << host;
  for (const char* host : {"", "0.0.0.0", "::", "10.0.0.1", "127.evil.com", "127.0.0.1.evil.com", "localhost.evil.com",
                           "127.0.0", "127..0.1", "1270.0.0.1", "127.0.0.1 ", "127.0.0.0001"})
    EXPECT_FALSE(is_loopback(host)) << host;
}

TEST(HttpGuard, FindsTheHostOfAnAuthority) {
  EXPECT_EQ(host_of("localhost:8080"), "localhost");
  EXPECT_EQ(host_of("localhost"), "localhost");
  EXPECT_EQ(host_of("[::1]:80"), "::1");
  EXPECT_EQ(host_of("[::1"), "");
  EXPECT_EQ(host_of(""), "");
}

// 2026-11-22: "[::1].evil" and "localhost:80@evil" were accepted as names of this machine.
TEST(HttpGuard, TakesAHostAndAPortAndNothingElseForAnAuthority) {
  const std::pair<const char*, const char*> good[] = {
      {"localhost", "localhost"},
      {"localhost:", "localhost"},
      {"localhost:0", "localhost"},
      {"LOCALHOST:80", "LOCALHOST"},
      {"127.0.0.1:65535", "127.0.0.1"},
      {"[::1]", "::1"},
      {"[::1]:", "::1"},
      {"[::1]:8080", "::1"},
      {"[fe80::1:2]:1", "fe80::1:2"},
      {"gpu-7.example:8080", "gpu-7.example"},
      {"my_node", "my_node"},
  };
  for (const auto& [authority, host] : good) EXPECT_EQ(host_of(authority), host) << authority;
  for (const char* bad : {"[::1].evil",
                          "[::1].evil:80",
                          "[::1]evil",
                          "[::1]:80.evil",
                          "[::1]80",
                          "[::1]@evil",
                          "[localhost]",
                          "[]",
                          "[]:80",
                          "[::1",
                          "::1",
                          "::1]",
                          "[::1]]",
                          "[[::1]]",
                          "[::1%lo]",
                          "[v1.a]",
                          "localhost:80@evil",
                          "localhost@evil",
                          "user@localhost",
                          "user:pass@localhost",
                          "localhost:80:80",
                          "localhost::80",
                          "localhost:+80",
                          "localhost:-1",
                          "localhost: 80",
                          "localhost:80 ",
                          " localhost",
                          "localhost ",
                          "localhost\t",
                          "localhost:65536",
                          "localhost:00000000000000000080000000",
                          "localhost:4294967376",
                          "localhost:http",
                          "localhost/",
                          "localhost/evil",
                          "localhost?evil",
                          "localhost#evil",
                          "localhost\\evil",
                          "localhost,evil",
                          "localhost, localhost",
                          "local%68ost",
                          ":80",
                          ":",
                          "@",
                          "localhost:80/@evil",
                          "http://localhost",
                          "//localhost",
                          "ünï.example"})
    EXPECT_EQ(host_of(bad), "") << bad;
  EXPECT_EQ(host_of(std::string_view("localhost\0.evil", 15)), "");
  EXPECT_EQ(host_of(std::string_view("[::1\0]", 6)), "");
  EXPECT_EQ(host_of(std::string(256, 'a')), "");
}

/// 2026-11-22: the hosts [::1].evil and localhost:80@evil were accepted.
TEST(HttpGuard, RefusesHostsThatAreNoneWhereverItListens) {
  for (const char* bad : {"", "[::1].evil", "localhost:80@evil", "localhost, evil"}) {
    EXPECT_EQ(guard_status(get(bad)), 403) << bad;
    EXPECT_EQ(guard_status(get(bad), false), 400) << bad;
  }
}

TEST(HttpGuard, RefusesANameThatSomebodyPointedHere) {
  EXPECT_EQ(guard_status(get("localhost:8080")), 200);
  EXPECT_EQ(guard_status(get("[::1]:8080")), 200);
  EXPECT_EQ(guard_status(get("evil.com:8080")), 403);
  EXPECT_EQ(guard_status(get("")), 403);
  EXPECT_EQ(guard_status(get("gpu-7.example:8080"), false), 200);  // on other addresses the token protects the server
}

TEST(HttpGuard, RefusesRequestsOfOtherPages) {
  RequestHead head = get("localhost:8080");
  head.origin = "http://localhost:8080";
  EXPECT_EQ(guard_status(head), 200);
  for (const char* other : {"http://localhost:81", "http://evil.com", "null", "http://localhost:8080.evil.com"}) {
    head.origin = other;
    EXPECT_EQ(guard_status(head), 403) << other;
  }
}

// 2026-11-25: a proxy on this machine needed --bind 0.0.0.0, and a refusal did not state the received Host and Origin.
TEST(HttpGuard, AcceptsHostAndOriginOfTheExternalUrl) {
  const ExternalUrl external = parse_external_url("HTTPS://Maps.example.com:443/village");
  EXPECT_EQ(external.host, "maps.example.com");
  EXPECT_EQ(external.origin, "https://maps.example.com");
  EXPECT_EQ(external.path, "/village/");
  RequestHead head = get("maps.example.com");
  head.origin = "https://maps.example.com";
  EXPECT_FALSE(refusal_of(head, true, external));
  head.host = "localhost:8080";  // a proxy that does not preserve Host
  EXPECT_FALSE(refusal_of(head, true, external));
  head.origin = "https://evil.example";
  const auto refusal = refusal_of(head, true, external);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->status, 403);
  EXPECT_NE(refusal->why.find("received Host 'localhost:8080' and Origin 'https://evil.example'"), std::string::npos);
  head.host = "evil.example";
  EXPECT_EQ(refusal_of(head, true, external)->status, 403);
}

TEST(HttpGuard, RemovesThePathOfTheExternalUrl) {
  const ExternalUrl external = parse_external_url("http://maps.example.com/village/");
  EXPECT_EQ(without_external_path("/village/stream", external), "/stream");
  EXPECT_EQ(without_external_path("/village/", external), "/");
  EXPECT_EQ(without_external_path("/stream", external), "/stream");
  EXPECT_EQ(without_external_path("/village/stream", {}), "/village/stream");
}

TEST(HttpGuard, RefusesExternalUrlsThatAreNone) {
  for (const char* bad :
       {"maps.example.com", "ftp://maps.example.com/", "https://", "https:///village/", "https://u@maps.example.com/",
        "https://maps.example.com/?a=b", "https://maps.example.com:x/"})
    EXPECT_THROW(parse_external_url(bad), UsageError) << bad;
}

TEST(HttpGuard, TakesSmallJsonBodiesWithALengthOnly) {
  EXPECT_EQ(guard_status(post("2")), 200);
  EXPECT_EQ(guard_status(post(std::to_string(max_body_bytes))), 200);
  EXPECT_EQ(guard_status(post(std::to_string(max_body_bytes + 1))), 413);
  EXPECT_EQ(guard_status(post("99999999999999999999999")), 413);
  for (const char* bad : {"", "-1", "2x", " 2", "0x2"}) EXPECT_EQ(guard_status(post(bad)), 411) << bad;
  RequestHead head = post("2");
  head.has_transfer_encoding = true;
  EXPECT_EQ(guard_status(head), 411);
  head = post("2");
  head.has_content_encoding = true;
  EXPECT_EQ(guard_status(head), 415);
  head = post("2");
  head.content_type = "text/plain";
  EXPECT_EQ(guard_status(head), 415);
  head.method = "DELETE";
  EXPECT_EQ(guard_status(head), 405);
}

TEST(HttpGuard, ComparesTokensWhole) {
  EXPECT_TRUE(equal_in_constant_time("0123456789abcdef", "0123456789abcdef"));
  for (const char* wrong :
       {"", "0", "0123456789abcde", "0123456789abcdeg", "0123456789abcdef0", "0123456789abcdef0123456789abcdef"})
    EXPECT_FALSE(equal_in_constant_time("0123456789abcdef", wrong)) << wrong;
  EXPECT_FALSE(equal_in_constant_time("", "a"));
}

TEST(HttpGuard, MakesKeysThatDiffer) {
  std::set<std::string> keys;
  for (int i = 0; i < 1000; ++i) {
    const std::string key = random_key();
    EXPECT_EQ(key.size(), 32u);
    EXPECT_TRUE(is_token(key));
    keys.insert(key);
  }
  EXPECT_EQ(keys.size(), 1000u);
}

TEST(HttpGuard, ReadsOneCookieAmongOthers) {
  EXPECT_EQ(cookie("a=1; gigabake_80=xyz; b=2", "gigabake_80"), "xyz");
  EXPECT_EQ(cookie("gigabake_80=xyz", "gigabake_80"), "xyz");
  EXPECT_EQ(cookie("gigabake_8080=no;gigabake_80=", "gigabake_80"), "");
  EXPECT_EQ(cookie(";;; ;=", "gigabake_80"), "");
  EXPECT_EQ(cookie("", "x"), "");
}

TEST(HttpGuard, TokensStandInUrlsAsTheyAre) {
  EXPECT_TRUE(is_token("aZ09-_"));
  for (const char* bad : {"a b", "a;b", "ü", "a%20", "a&b"}) EXPECT_FALSE(is_token(bad)) << bad;
}

}  // namespace
}  // namespace gigabake
