/// A TCP port that is listened on.
#pragma once

#include <string>

namespace gigabake {

/// Owns the socket; closes it.
class ListenSocket {
 public:
  /// address: a name, or numbers of IPv4 or IPv6. port 0: any that is free.
  /// Errors  InputError: nobody can listen there, or somebody does.
  ListenSocket(const std::string& address, int port);
  ~ListenSocket();
  ListenSocket(const ListenSocket&) = delete;
  ListenSocket& operator=(const ListenSocket&) = delete;

  int descriptor() const { return socket_; }
  int port() const;
  /// Gives the socket away: whoever takes it closes it.
  int release();

 private:
  int socket_ = -1;
};

}  // namespace gigabake
