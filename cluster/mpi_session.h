/// MPI as this program uses it: one thread talks, messages are bytes, every call is checked.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gigabake {

struct Message {
  int from = 0, tag = 0;
  std::vector<std::uint8_t> bytes;
};

/// MPI_Init to MPI_Finalize; without mpirun a world of one rank. One per process.
/// Errors  std::runtime_error with the MPI call and its own text.
class MpiSession {
 public:
  MpiSession();
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  int ranks_on_this_host() const { return ranks_on_host_; }

  void send(int to, int tag, std::span<const std::uint8_t> bytes);
  /// A message if one has arrived; never waits (a waiting receive burns a core).
  std::optional<Message> poll();
  /// The largest value of any rank. Collective.
  int max_of(int value);
  /// Rank 0's value. Collective.
  int from_master(int value);
  /// Ends all ranks at once.
  [[noreturn]] void abort(int exit_code);

 private:
  int rank_ = 0, ranks_ = 1, ranks_on_host_ = 1;
};

}  // namespace gigabake
