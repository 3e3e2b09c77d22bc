#include "viewer/web/http_guard.h"

#include <algorithm>
#include <arpa/inet.h>
#include <charconv>
#include <random>

namespace gigabake {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// Returns true for four numbers of at most three digits of which the first is 127.
bool is_loopback_v4(std::string_view host) {
  int dots = 0, digits = 0;
  for (const char c : host) {
    if (c == '.' ? digits == 0 : !is_digit(c) || digits == 3) return false;
    digits = c == '.' ? 0 : digits + 1;
    dots += c == '.';
  }
  return dots == 3 && digits > 0 && host.starts_with("127.");
}

/// Returns true for an empty text, and for ":" and the digits of a port.
bool is_port(std::string_view text) {
  if (text.empty()) return true;
  std::uint32_t port = 0;
  for (const char c : text.substr(1)) {
    if (!is_digit(c) || port > 65535) return false;
    port = 10 * port + std::uint32_t(c - '0');
  }
  return text.starts_with(':') && port <= 65535;
}

bool is_ipv6(std::string_view host) {
  in6_addr address{};
  return host.find('\0') == std::string_view::npos && ::inet_pton(AF_INET6, std::string(host).c_str(), &address) == 1;
}

/// Returns true for a host name or IPv4 address; accepts fewer characters than RFC 3986 does.
bool is_name(std::string_view host) {
  return !host.empty() && host.size() <= 255 && std::all_of(host.begin(), host.end(), [](char c) {
    return is_digit(c) || is_letter(c) || c == '-' || c == '.' || c == '_';
  });
}

/// Returns the Host and Origin that the server received, as help for the configuration of a proxy.
std::string received(const RequestHead& head) {
  constexpr std::size_t max_shown = 200;
  const auto shown = [](const std::string& text) {
    return text.empty() ? "none" : "'" + text.substr(0, max_shown) + "'";
  };
  return "; received Host " + shown(head.host) + " and Origin " + shown(head.origin);
}

std::optional<Refusal> refusal_of_body(const RequestHead& head) {
  // A body without a length could be endless.
  if (head.has_transfer_encoding) return Refusal{411, "expected a body with a Content-Length"};
  if (head.has_content_encoding) return Refusal{415, "expected a body that is not compressed"};
  std::uint64_t length = 0;
  const char* end = head.content_length.data() + head.content_length.size();
  const auto [at, error] = std::from_chars(head.content_length.data(), end, length);
  if (error == std::errc::result_out_of_range || length > max_body_bytes)
    return Refusal{413, "expected a body of at most " + std::to_string(max_body_bytes) + " bytes"};
  if (error != std::errc() || at != end) return Refusal{411, "expected a Content-Length"};
  // Pages of other origins can send forms and plain text without a preflight request, but not JSON.
  if (!ascii_lower(head.content_type).starts_with("application/json")) return Refusal{415, "expected application/json"};
  return std::nullopt;
}

}  // namespace

std::string ascii_lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return out;
}

bool is_loopback(std::string_view host) {
  return ascii_lower(host) == "localhost" || host == "::1" || is_loopback_v4(host);
}

std::string_view host_of(std::string_view authority) {
  if (authority.starts_with('[')) {
    const std::size_t end = authority.find(']');
    if (end == std::string_view::npos || !is_port(authority.substr(end + 1))) return {};
    const std::string_view host = authority.substr(1, end - 1);
    return is_ipv6(host) ? host : std::string_view();
  }
  const std::size_t end = std::min(authority.find(':'), authority.size());
  const std::string_view host = authority.substr(0, end);
  return is_name(host) && is_port(authority.substr(end)) ? host : std::string_view();
}

bool equal_in_constant_time(std::string_view secret, std::string_view given) {
  unsigned difference = secret.size() == given.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const char expected = secret.empty() ? '\0' : secret[i % secret.size()];
    difference |= unsigned(static_cast<unsigned char>(expected ^ given[i]));
  }
  return difference == 0;
}

std::string random_key() {
  constexpr std::string_view digits = "0123456789abcdef";
  std::random_device random;
  std::string out;
  for (int word = 0; word < 4; ++word) {
    const unsigned bits = random();
    for (int shift = 0; shift < 32; shift += 4) out += digits[(bits >> shift) & 15];
  }
  return out;
}

bool is_token(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return is_digit(c) || is_letter(c) || c == '-' || c == '_'; });
}

std::string_view cookie(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = std::min(header.find(';'), header.size());
    std::string_view pair = header.substr(0, end);
    while (pair.starts_with(' ')) pair.remove_prefix(1);
    if (pair.starts_with(name) && pair.substr(name.size()).starts_with('=')) return pair.substr(name.size() + 1);
    header.remove_prefix(std::min(end + 1, header.size()));
  }
  return {};
}

std::optional<Refusal> refusal_of(const RequestHead& head, bool local, const ExternalUrl& external) {
  if (head.method != "GET" && head.method != "HEAD" && head.method != "POST")
    return Refusal{405, "expected GET, HEAD or POST"};
  const std::string_view host = host_of(head.host);
  if (!local && host.empty()) return Refusal{400, "expected one Host header: a name or an address, and a port"};
  const bool is_external = !host.empty() && ascii_lower(host) == external.host;
  if (local && !is_loopback(host) && !is_external)
    return Refusal{403,
                   "expected the host localhost" + received(head) +
                       "; to serve other machines, start with `bind` and a token; behind a proxy, with `external_url`"};
  const std::string origin = ascii_lower(head.origin);
  if (!origin.empty() && origin != "http://" + ascii_lower(head.host) &&
      origin != "https://" + ascii_lower(head.host) && (external.host.empty() || origin != external.origin))
    return Refusal{403, "expected a request from this server's own page" + received(head) +
                            "; behind a proxy that changes Host, start with `external_url`"};
  return head.method == "POST" ? refusal_of_body(head) : std::nullopt;
}

}  // namespace gigabake
