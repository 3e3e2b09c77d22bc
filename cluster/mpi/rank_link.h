/// Transport, clock and signals of rank 0 during dispatch. The interface is all that dispatch() needs, so that a test
/// can simulate every rank (tests/cluster/scripted_ranks.h).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cluster/mpi/message.h"

namespace gigabake {

/// A link that treats rank 0 like every other rank: rank 0 receives its own cells and answers through it.
class RankLink {
 public:
  virtual ~RankLink() = default;

  virtual int ranks() const = 0;
  /// Returns monotonic seconds from an arbitrary origin.
  virtual double now_s() const = 0;
  /// Returns true if an early, orderly end of the bake was requested.
  virtual bool is_drain_requested() const = 0;
  /// Sends a message and returns immediately. Messages to one rank arrive in order, or never if that rank is lost.
  virtual void send(int rank, Tag tag, std::vector<std::uint8_t> bytes) = 0;
  /// Returns the next message from any rank, if any; never blocks.
  virtual std::optional<Message> receive() = 0;
  /// Returns after some milliseconds, or earlier if receive() may have a message.
  virtual void wait() = 0;
};

}  // namespace gigabake
