/// The connection of a rank's bake process to rank 0: it passes orders to the process, and answers back. Every rank has
/// one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cluster/mpi/message.h"
#include "cluster/process/bake_process.h"

namespace gigabake {

class RankBaker {
 public:
  explicit RankBaker(BakeProcess& process) : process_(process) {}

  /// Handles the payload of a tag_job message. Drops an order that rank 0 sent before it knew of the process's last
  /// death, because rank 0 counts the order's cell as lost with that process.
  /// Errors  InputError: the payload is malformed.
  void handle(std::span<const std::uint8_t> order);
  /// Returns the next tag_device, tag_report or tag_died message for rank 0, if any. Never blocks. A process that never
  /// reports its device, because it ends before, is reported as a device's error.
  std::optional<Message> answer();

 private:
  std::optional<Message> next_event();
  std::optional<DeviceAnswer> device() const;

  BakeProcess& process_;
  std::uint32_t deaths_ = 0;          ///< number of deaths of the process that were reported to rank 0
  std::optional<DeviceAnswer> told_;  ///< the device that was reported to rank 0
  std::string last_death_;
  std::optional<Message> held_;  ///< an event that came with the device
};

/// Returns the payload of a tag_job message. `deaths` is the number of deaths of the rank's bake process that rank 0
/// has counted.
std::vector<std::uint8_t> order_bytes(std::uint32_t deaths, const BakeOrder& order);

}  // namespace gigabake
