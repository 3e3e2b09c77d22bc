/// Wrapper of MPI: one thread makes all calls, messages are bytes, every call is checked.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "cluster/mpi/message.h"

namespace gigabake {

/// Another rank died or hangs, and this launch cannot continue without it. A new launch of the same command can.
class RankLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The use of MPI by a process, from MPI_Init to MPI_Finalize. Without mpirun, the world has one rank. A process may
/// create only one session. The process ends if its mpirun dies.
/// Errors  RankLost with the MPI call and MPI's error text. If MPI_Init or MPI_Finalize takes too long because another
///         rank died or hangs, the process ends: cluster/mpi/mpi_call_timeout.h.
class MpiSession {
 public:
  MpiSession();
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  /// Returns this rank's index among the ranks of its host.
  int rank_on_host() const { return rank_on_host_; }
  int ranks_on_host() const { return ranks_on_host_; }
  /// Returns the number of cores of the host that the container or job may use, independent of this rank's binding.
  int host_cores() const;
  /// Returns this rank's even share of the cores of its host that the container or job may use; at least 1.
  int cores() const { return cores_; }

  /// Sends without blocking and keeps the bytes until they are sent, so two ranks may send to each other. Messages
  /// between two ranks arrive in the order of sending.
  void send(int to, int tag, std::vector<std::uint8_t> bytes);
  /// Advances pending sends; poll() does the same.
  void progress();
  /// Returns a message if one has arrived; never blocks, because a blocking receive would busy-wait.
  std::optional<Message> poll();
  /// Sets the timeout of collective calls in seconds. A call that takes longer throws RankLost on every waiting rank,
  /// because MPI would wait forever for a rank that hangs. No other collective call may follow.
  void set_collective_timeout(double collective_timeout_s) { collective_timeout_s_ = collective_timeout_s; }
  double collective_timeout_s() const { return collective_timeout_s_; }
  /// Collective. Returns the max over all ranks.
  std::int64_t max_of(std::int64_t value);
  /// Collective. Returns the sum over all ranks.
  std::int64_t sum_of(std::int64_t value);
  /// Collective. Returns rank 0's value.
  int from_master(int value);
  /// Collective. Returns rank 0's bytes. Their number is not limited.
  std::vector<std::uint8_t> from_master(std::vector<std::uint8_t> bytes);
  /// Ends all ranks immediately.
  [[noreturn]] void abort(int exit_code);

 private:
  struct Outbox;
  struct Inbox;
  std::unique_ptr<Outbox> outbox_;
  std::unique_ptr<Inbox> inbox_;
  double collective_timeout_s_ = 600;
  int rank_ = 0, ranks_ = 1, rank_on_host_ = 0, ranks_on_host_ = 1, cores_ = 1;
};

}  // namespace gigabake
