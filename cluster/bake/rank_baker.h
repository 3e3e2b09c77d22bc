/// Passes rank 0's orders to this rank's bake process, and the answers back. Every rank has one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "cluster/mpi/message.h"
#include "cluster/process/bake_process.h"

namespace gigabake {

class RankBaker {
 public:
  explicit RankBaker(BakeProcess& process) : process_(process) {}

  /// Handles the payload of a tag_job. Drops an order that rank 0 sent before it learned of the last death: rank 0
  /// counts that cell as lost with the process.
  /// Errors  InputError when malformed.
  void handle(std::span<const std::uint8_t> order);
  /// Returns the next tag_report or tag_died for rank 0, if any; never blocks.
  std::optional<Message> answer();

 private:
  BakeProcess& process_;
  std::uint32_t deaths_ = 0;  ///< of the process, as reported to rank 0
};

/// Returns the payload of a tag_job. deaths: number of deaths of the rank's bake process that rank 0 has counted.
std::vector<std::uint8_t> order_bytes(std::uint32_t deaths, const CellJob& job, std::uint32_t attempt);

}  // namespace gigabake
