/// Addresses under which other machines reach the server: through a proxy, or when it is bound to all addresses.
#pragma once

#include <string>
#include <string_view>

namespace gigabake {

/// The URL under which a proxy publishes the server.
struct ExternalUrl {
  std::string host;    ///< lower case, without brackets and port; empty: no proxy
  std::string origin;  ///< scheme, host and port, in the form of a browser's Origin header
  std::string path;    ///< begins and ends with '/'
};

/// Parses a URL: http:// or https://, a host, an optional port and an optional path. An empty text gives an empty
/// result.
/// Errors  UsageError: any other text.
ExternalUrl parse_external_url(std::string_view text);

/// Returns a request's path without the external URL's path, which some proxies keep in requests.
std::string_view without_external_path(std::string_view path, const ExternalUrl& external);

/// Returns an address under which other machines reach the server: `bind`, or an address of this machine if `bind` is a
/// wildcard (0.0.0.0, ::). Returns the machine's host name if it has only loopback addresses.
std::string reachable_host(const std::string& bind);

}  // namespace gigabake
