/// Access control of the server: tokens, host names and cross-origin requests. Pure functions of request headers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "viewer/web/external_url.h"

namespace gigabake {

/// Returns the text with the letters A to Z in lower case, independent of the locale.
std::string ascii_lower(std::string_view text);

/// Returns true for "localhost", "::1" and 127.x.y.z, which other machines cannot reach.
bool is_loopback(std::string_view host);

/// Returns the host of a Host header without port and brackets: "[::1]:80" gives "::1". Returns "" unless the header is
/// exactly host [":" port] (RFC 3986).
std::string_view host_of(std::string_view authority);

/// Compares texts in a time that depends only on the length of `given`, so that timing does not reveal the secret.
bool equal_in_constant_time(std::string_view secret, std::string_view given);

/// Returns 32 hexadecimal digits from the system's random source.
std::string random_key();

/// Returns true if the text has only letters, digits, '-' and '_', which need no escaping in URLs and cookies.
bool is_token(std::string_view text);

/// Returns the value of one cookie of a Cookie header; empty if it is absent.
std::string_view cookie(std::string_view header, std::string_view name);

/// The parts of a request that are checked before its body is read.
struct RequestHead {
  std::string method, host, origin, content_type, content_length;
  bool has_transfer_encoding = false, has_content_encoding = false;
};

struct Refusal {
  int status = 0;
  std::string why;
};

inline constexpr std::uint64_t max_body_bytes = 4096;

/// Returns the reason why a request is refused; nullopt if the request is accepted.
/// `local` is true if the server is bound to a loopback address. A Host other than localhost then indicates a foreign
/// page whose host name resolves to this machine (DNS rebinding). `external` is the proxy's URL. Its host is accepted
/// like localhost, and its origin like the server's origin.
std::optional<Refusal> refusal_of(const RequestHead& head, bool local, const ExternalUrl& external = {});

}  // namespace gigabake
