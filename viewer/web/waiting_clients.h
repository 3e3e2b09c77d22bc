/// Connections with an incomplete request, and the times at which they are closed. A connection is closed at its
/// timeout; the oldest one also if too many wait. Slow or silent clients therefore cannot block others.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

namespace gigabake {

/// Thread-safe: any thread may call any member. Dropped sockets are shut down, not closed: their owner notices that,
/// closes them and calls closed().
class WaitingClients {
 public:
  using Clock = std::chrono::steady_clock;

  /// maximum: limit of waiting clients. request_timeout: time limit from a client's connection, or its last answer, to
  /// the end of its request.
  WaitingClients(std::size_t maximum, Clock::duration request_timeout)
      : max_count_(maximum), request_timeout_(request_timeout) {}

  /// Starts to wait for a request on the socket.
  void expect(int socket, Clock::time_point now);
  /// Records that a complete request has arrived.
  void heard(int socket);
  void closed(int socket) { heard(socket); }
  void drop_late(Clock::time_point now);

 private:
  void drop_oldest();

  const std::size_t max_count_;
  const Clock::duration request_timeout_;
  std::mutex mutex_;
  std::uint64_t count_ = 0;
  struct Waiting {
    int socket;
    Clock::time_point since;
  };
  std::map<std::uint64_t, Waiting> in_order_;  ///< oldest first
  std::map<int, std::uint64_t> order_of_;      ///< by socket
};

}  // namespace gigabake
