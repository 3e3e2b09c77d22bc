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

/// Returns a request's path without the path of the external URL, which some proxies keep.
std::string_view without_external_path(std::string_view path, const ExternalUrl& external);

/// Returns an address that other hosts can open: `bind`, or for a wildcard (0.0.0.0, ::) an address of this machine.
/// A machine that has only loopback addresses is named by its host name.
std::string reachable_host(const std::string& bind);

}  // namespace gigabake
