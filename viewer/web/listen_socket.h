/// A listening TCP socket.
#pragma once

#include <string>

namespace gigabake {

/// Owns the socket; closes it.
class ListenSocket {
 public:
  /// Binds the address and listens. address: a name, or a numeric IPv4 or IPv6 address. port 0: any free port.
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
