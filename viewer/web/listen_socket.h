/// A listening TCP socket.
#pragma once

#include <string>

namespace gigabake {

/// The owner of a listening TCP socket, which the destructor closes.
class ListenSocket {
 public:
  /// Binds the address and listens. `address` is a host name or a numeric IPv4 or IPv6 address. Port 0 selects any free
  /// port.
  /// Errors  InputError: the address is invalid, or another process uses the port.
  ListenSocket(const std::string& address, int port);
  ~ListenSocket();
  ListenSocket(const ListenSocket&) = delete;
  ListenSocket& operator=(const ListenSocket&) = delete;

  int descriptor() const { return socket_; }
  int port() const;
  /// Returns the descriptor and passes its ownership to the caller.
  int release();

 private:
  int socket_ = -1;
};

}  // namespace gigabake
