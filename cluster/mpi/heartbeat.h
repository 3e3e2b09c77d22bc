/// Heartbeats from a rank to rank 0.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "cluster/mpi/mpi_session.h"
#include "cluster/process/bake_process.h"

namespace gigabake {

struct Heartbeat {
  std::uint64_t peak_bytes = 0;  ///< max over the rank's bake processes so far
  std::string host;
};
/// Errors  InputError: `bytes` are malformed.
Heartbeat heartbeat_from_bytes(const std::vector<std::uint8_t>& bytes);

/// Heartbeat sender of a rank.
class HeartbeatSender {
 public:
  HeartbeatSender(MpiSession& mpi, const BakeProcess& process) : mpi_(mpi), process_(process) {}
  /// Sends a heartbeat if the last heartbeat is old enough.
  void show();

 private:
  MpiSession& mpi_;
  const BakeProcess& process_;
  std::chrono::steady_clock::time_point shown_{};
};

}  // namespace gigabake
