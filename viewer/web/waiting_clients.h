/// Connections whose request is not here yet, and when they are dropped: late ones, and the oldest where too many wait.
/// So somebody who sends slowly, or nothing, keeps nobody out.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

namespace gigabake {

/// All members may be called from any thread. Sockets that are dropped are shut down, not closed: whoever owns them
/// notices, closes them and calls closed().
class WaitingClients {
 public:
  using Clock = std::chrono::steady_clock;

  /// most: how many may wait. patience: from its connection, or its last answer, to the end of a client's request.
  WaitingClients(std::size_t most, Clock::duration patience) : most_(most), patience_(patience) {}

  /// A request is waited for from now on.
  void expect(int socket, Clock::time_point now);
  /// All of the request is here.
  void heard(int socket);
  void closed(int socket) { heard(socket); }
  void drop_late(Clock::time_point now);

 private:
  void drop_oldest();

  const std::size_t most_;
  const Clock::duration patience_;
  std::mutex mutex_;
  std::uint64_t count_ = 0;
  struct Waiting {
    int socket;
    Clock::time_point since;
  };
  std::map<std::uint64_t, Waiting> in_order_;  ///< the oldest first
  std::map<int, std::uint64_t> order_of_;      ///< by socket
};

}  // namespace gigabake
