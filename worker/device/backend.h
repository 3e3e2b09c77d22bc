/// Selection of the device that a rank's kernels run on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/rules.h"

namespace gigabake {

enum class Backend : std::uint8_t { automatic, cpu, cuda };
template <>
constexpr auto names_of<Backend>() {
  return std::to_array<std::string_view>({"auto", "cpu", "cuda"});
}

/// The device request of the rank with index `rank_on_host` on its host.
struct DeviceRequest {
  Backend backend = Backend::cpu;
  std::vector<int> allowed = {};  ///< CUDA ordinals that may be chosen; empty means all
  int rank_on_host = 0;
  int ranks_on_host = 1;
  /// The driver is started only if a cell must be baked from its source. Cells made from stored shards need no device.
  bool only_if_needed = false;

  bool operator==(const DeviceRequest&) const = default;
};

struct DeviceChoice {
  std::optional<int> device;       ///< CUDA ordinal; nullopt means the CPU
  std::string reason;              ///< reason why Backend::automatic chose the CPU; else empty
  int sharers = 1;                 ///< ranks of the host that use this device, including this rank
  std::uint64_t device_bytes = 0;  ///< this rank's share of three quarters of the device's memory; 0: no device

  bool operator==(const DeviceChoice&) const = default;
};

/// Returns how many of `ranks` use the device of rank `rank` when they are assigned to `devices` round-robin.
/// Range   0 ≤ rank < ranks; devices > 0.
int sharers_of_device(int rank, int ranks, int devices);

/// Returns whether this build has kernels for GPUs.
bool is_built_for_devices();

/// Returns the device of a rank. The ranks of a host are assigned to its devices round-robin, so several ranks share a
/// device if there are fewer devices than ranks.
/// Errors  InputError if Backend::cuda is requested and the host has no usable device. UsageError if an allowed ordinal
///         is not a usable device of the host.
DeviceChoice choose_device(const DeviceRequest& requested);

}  // namespace gigabake
