/// MPI as this program uses it: one thread talks, messages are bytes, every call is checked.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "cluster/message.h"

namespace gigabake {

/// Another rank died or hangs, and this launch cannot go on without it; another launch of the same command can.
class RankLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// MPI_Init to MPI_Finalize; without mpirun a world of one rank. One per process, which ends with its mpirun.
/// Errors  RankLost with the MPI call and its own text. A start or an end that takes too long because another
///         rank died or hangs ends the process: cluster/time_bound.h.
class MpiSession {
 public:
  MpiSession();
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  /// Counts the ranks of this rank's host.
  int rank_on_host() const { return rank_on_host_; }
  int ranks_on_host() const { return ranks_on_host_; }
  /// All cores of its host that its container or job may use, whichever this rank is bound to.
  int host_cores() const;
  /// This rank's even share of the cores of its host that its container or job may use, at least 1.
  int cores() const { return cores_; }

  /// Returns at once and keeps the bytes until they are gone: two ranks may send to each other without waiting.
  /// Messages between two ranks arrive in the order in which they were sent.
  void send(int to, int tag, std::vector<std::uint8_t> bytes);
  /// Moves what was sent on its way; poll() does it too.
  void progress();
  /// A message if one has arrived; never waits (a waiting receive burns a core).
  std::optional<Message> poll();
  /// A collective call that takes longer than this throws RankLost on every rank that waits: one of them hangs, and MPI
  /// would wait for it for ever. No other collective call may follow.
  void set_patience(double patience_s) { patience_s_ = patience_s; }
  double patience_s() const { return patience_s_; }
  /// The largest value of any rank. Collective.
  std::int64_t max_of(std::int64_t value);
  /// The sum of all ranks' values. Collective.
  std::int64_t sum_of(std::int64_t value);
  /// Rank 0's value. Collective.
  int from_master(int value);
  /// Rank 0's bytes, however many. Collective.
  std::vector<std::uint8_t> from_master(std::vector<std::uint8_t> bytes);
  /// Ends all ranks at once.
  [[noreturn]] void abort(int exit_code);

 private:
  struct Outbox;
  std::unique_ptr<Outbox> outbox_;
  double patience_s_ = 600;
  int rank_ = 0, ranks_ = 1, rank_on_host_ = 0, ranks_on_host_ = 1, cores_ = 1;
};

}  // namespace gigabake
