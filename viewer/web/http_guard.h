/// Who may talk to the server: tokens, names of hosts, requests that no page of ours makes. Pure functions of headers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "viewer/web/external_url.h"

namespace gigabake {

/// Returns the text with the letters A to Z in lower case, whatever the locale.
std::string ascii_lower(std::string_view text);

/// "localhost", "::1" or 127.x.y.z: nobody reaches it from another machine.
bool is_loopback(std::string_view host);

/// The host of a Host header: RFC 3986's host [":" port] and nothing else, without its port and brackets. "[::1]:80"
/// gives "::1"; what is none of these, or has no host, gives "".
std::string_view host_of(std::string_view authority);

/// Time does not depend on where the texts differ, only on the length of `given`.
bool equal_in_constant_time(std::string_view secret, std::string_view given);

/// 32 hexadecimal digits from the system's source of randomness.
std::string random_key();

/// Letters, digits, '-' and '_' only: it stands in URLs and cookies as it is.
bool is_token(std::string_view text);

/// The value of one cookie of a Cookie header; empty where it is not there.
std::string_view cookie(std::string_view header, std::string_view name);

/// What of a request matters before its body is read.
struct RequestHead {
  std::string method, host, origin, content_type, content_length;
  bool has_transfer_encoding = false, has_content_encoding = false;
};

struct Refusal {
  int status = 0;
  std::string why;
};

inline constexpr std::uint64_t most_body_bytes = 4096;

/// local: bound to this machine only; then a Host of another name is a page that had its name point here. external: of
/// the proxy that shows this server; its host is expected like localhost, its origin like the server's own.
std::optional<Refusal> refusal_of(const RequestHead& head, bool local, const ExternalUrl& external = {});

}  // namespace gigabake
