#include "viewer/web/listen_socket.h"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <memory>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include "core/base/error.h"

namespace gigabake {
namespace {

[[noreturn]] void fail_to_listen(const std::string& address, int port, const std::string& why) {
  throw InputError(fmt::format("{}:{}", address, port), "",
                   "cannot listen there (" + why + "); is another server using it? `port` 0 selects a free port");
}

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

Addresses addresses_of(const std::string& address, int port) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int error = ::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &list);
  if (error != 0) fail_to_listen(address, port, ::gai_strerror(error));
  return Addresses(list);
}

/// Returns a listening socket. On failure, returns −1 and sets errno. SO_REUSEPORT is not set, because two servers
/// would share the port and its clients.
int listen_at(const addrinfo& at) {
  const int socket = ::socket(at.ai_family, at.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, at.ai_protocol);
  if (socket < 0) return -1;
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (::bind(socket, at.ai_addr, at.ai_addrlen) == 0 && ::listen(socket, SOMAXCONN) == 0) return socket;
  const int error = errno;
  ::close(socket);
  errno = error;
  return -1;
}

}  // namespace

ListenSocket::ListenSocket(const std::string& address, int port) {
  const Addresses list = addresses_of(address, port);
  for (const addrinfo* at = list.get(); at != nullptr && socket_ < 0; at = at->ai_next) socket_ = listen_at(*at);
  if (socket_ < 0) fail_to_listen(address, port, std::strerror(errno));
}

ListenSocket::~ListenSocket() {
  if (socket_ >= 0) ::close(socket_);
}

int ListenSocket::port() const {
  sockaddr_storage at{};
  socklen_t size = sizeof at;
  ::getsockname(socket_, reinterpret_cast<sockaddr*>(&at), &size);
  const bool six = at.ss_family == AF_INET6;
  return ntohs(six ? reinterpret_cast<sockaddr_in6&>(at).sin6_port : reinterpret_cast<sockaddr_in&>(at).sin_port);
}

int ListenSocket::release() { return std::exchange(socket_, -1); }

}  // namespace gigabake
