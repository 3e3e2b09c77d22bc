/// What rank 0 hears, says and knows of the world while it hands out cells: all that dispatch() needs, so that a test
/// can play every rank, the clock and the signals by itself (tests/cluster/scripted_ranks.h).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cluster/message.h"

namespace gigabake {

/// Rank 0 is a rank as every other one: it is sent its own cells, and answers.
class RankLink {
 public:
  virtual ~RankLink() = default;

  virtual int ranks() const = 0;
  /// Monotonic seconds of any origin.
  virtual double now_s() const = 0;
  /// Somebody wants the bake to end soon and in order.
  virtual bool is_drain_asked() const = 0;
  /// Returns at once. What is sent to one rank arrives in that order, or, where that rank is gone, never.
  virtual void send(int rank, Tag tag, std::vector<std::uint8_t> bytes) = 0;
  /// What has arrived, from any rank; never waits.
  virtual std::optional<Message> receive() = 0;
  /// Returns after some milliseconds, or earlier where receive() may have something.
  virtual void wait() = 0;
};

}  // namespace gigabake
