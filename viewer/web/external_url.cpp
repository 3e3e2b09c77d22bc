#include "viewer/web/external_url.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cstring>
#include <ifaddrs.h>
#include <memory>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <optional>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/error.h"
#include "viewer/web/http_guard.h"

namespace gigabake {
namespace {

bool is_path(std::string_view text) {
  constexpr std::string_view allowed = "-._~/%+";
  return std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           allowed.find(c) != std::string_view::npos;
  });
}

[[noreturn]] void refuse(std::string_view text) {
  throw UsageError("external_url",
                   "expected http://HOST/ or https://HOST:PORT/PATH/, got '" + std::string(text.substr(0, 100)) + "'");
}

/// Returns the address family of a wildcard address; nullopt for other addresses.
std::optional<int> wildcard_family(const std::string& bind) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST;
  addrinfo* list = nullptr;
  if (::getaddrinfo(bind.c_str(), nullptr, &hints, &list) != 0) return std::nullopt;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(list, ::freeaddrinfo);
  if (list->ai_family == AF_INET)
    return reinterpret_cast<sockaddr_in*>(list->ai_addr)->sin_addr.s_addr == INADDR_ANY ? std::optional(AF_INET)
                                                                                        : std::nullopt;
  const in6_addr& six = reinterpret_cast<sockaddr_in6*>(list->ai_addr)->sin6_addr;
  return IN6_IS_ADDR_UNSPECIFIED(&six) ? std::optional(AF_INET6) : std::nullopt;
}

/// Returns this machine's address on the route to `target`. Connecting a UDP socket sends no packet.
std::string address_towards(const std::string& target, int family) {
  addrinfo hints{};
  hints.ai_family = family;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICHOST;
  addrinfo* list = nullptr;
  if (::getaddrinfo(target.c_str(), "9", &hints, &list) != 0) return "";
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(list, ::freeaddrinfo);
  const int socket = ::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  std::array<char, NI_MAXHOST> text{};
  const bool found =
      socket >= 0 && ::connect(socket, list->ai_addr, list->ai_addrlen) == 0 &&
      ::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
      ::getnameinfo(reinterpret_cast<sockaddr*>(&own), size, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) == 0;
  if (socket >= 0) ::close(socket);
  return found && !is_loopback(text.data()) ? text.data() : "";
}

/// Returns the first IPv4 address of an interface that is up and not a loopback.
std::string first_interface_address() {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return "";
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, ::freeifaddrs);
  for (const ifaddrs* at = list; at != nullptr; at = at->ifa_next) {
    if (at->ifa_addr == nullptr || at->ifa_addr->sa_family != AF_INET || !(at->ifa_flags & IFF_UP) ||
        (at->ifa_flags & IFF_LOOPBACK))
      continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* four = reinterpret_cast<const sockaddr_in*>(at->ifa_addr);
    if (::inet_ntop(AF_INET, &four->sin_addr, text.data(), text.size())) return text.data();
  }
  return "";
}

std::string own_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 && name[0] ? name.data() : "localhost";
}

}  // namespace

ExternalUrl parse_external_url(std::string_view text) {
  if (text.empty()) return {};
  const std::size_t scheme_end = text.find("://");
  if (scheme_end == std::string_view::npos) refuse(text);
  const std::string scheme = ascii_lower(text.substr(0, scheme_end));
  const std::string_view rest = text.substr(scheme_end + 3);
  const std::size_t path_start = std::min(rest.find('/'), rest.size());
  std::string authority = ascii_lower(rest.substr(0, path_start));
  ExternalUrl out{std::string(host_of(authority)), "", std::string(rest.substr(path_start))};
  if ((scheme != "http" && scheme != "https") || out.host.empty() || !is_path(out.path)) refuse(text);
  const std::string default_port = scheme == "http" ? ":80" : ":443";
  if (authority.ends_with(default_port)) authority.resize(authority.size() - default_port.size());
  if (authority.ends_with(':')) authority.pop_back();
  out.origin = scheme + "://" + authority;
  if (!out.path.ends_with('/')) out.path += '/';
  return out;
}

std::string_view without_external_path(std::string_view path, const ExternalUrl& external) {
  return !external.host.empty() && path.starts_with(external.path) ? path.substr(external.path.size() - 1) : path;
}

std::string reachable_host(const std::string& bind) {
  const std::optional<int> family = wildcard_family(bind);
  if (!family) return bind;
  // The route to a documentation address (RFC 5737, RFC 3849) is the default route.
  std::string found = *family == AF_INET6 ? address_towards("2001:db8::1", AF_INET6) : "";
  if (found.empty()) found = address_towards("192.0.2.1", AF_INET);
  if (found.empty()) found = first_interface_address();
  return found.empty() ? own_name() : found;
}

}  // namespace gigabake
