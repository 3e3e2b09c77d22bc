/// Connections with an incomplete request. A connection is closed when its time limit has passed. If too many
/// connections wait, the oldest connection is closed. Slow or silent clients therefore cannot block others.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

namespace gigabake {

/// The set of waiting connections. Thread-safe: any thread may call any member. Dropped sockets are shut down, not
/// closed. The owner of a socket notices the shutdown, closes the socket and calls closed().
class WaitingClients {
 public:
  using Clock = std::chrono::steady_clock;

  /// Takes the maximum number of waiting clients and the time limit of a request. The time runs from the client's
  /// connection, or from the last answer to the client, to the end of the request.
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
