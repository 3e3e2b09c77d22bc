/// Addresses of a server as others see it: behind a proxy, and on a machine of which every address is listened on.
#pragma once

#include <string>
#include <string_view>

namespace gigabake {

/// The address under which a proxy shows a server.
struct ExternalUrl {
  std::string host;    ///< in small letters, without brackets and port; empty: there is no proxy
  std::string origin;  ///< scheme, host and port as browsers write an Origin
  std::string path;    ///< begins and ends with '/'
};

/// Errors  UsageError: not http:// or https://, a host, perhaps a port and a path.
ExternalUrl parse_external_url(std::string_view text);

/// Returns the path of a request without the path of the external URL, which a proxy may have kept.
std::string_view without_external_path(std::string_view path, const ExternalUrl& external);

/// Returns an address that other hosts can open: `bind`, or for a wildcard (0.0.0.0, ::) this machine's own address,
/// its name if it has none beyond the loopback.
std::string reachable_host(const std::string& bind);

}  // namespace gigabake
