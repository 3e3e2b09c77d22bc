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
  std::vector<int> allowed = {};  ///< ordinals to choose from; empty: all
  int rank_on_host = 0;
  int ranks_on_host = 1;
};

struct DeviceChoice {
  std::optional<int> device;  ///< none: the CPU
  std::string reason;         ///< reason for the CPU, if a device was requested or the choice was automatic
  int sharers = 1;            ///< ranks of the host that use this device, including this rank
};

/// Returns how many of `ranks` use the device of rank `rank` when they are assigned to `devices` round-robin.
/// Range   0 ≤ rank < ranks; devices > 0.
int sharers_of_device(int rank, int ranks, int devices);

/// Assigns the ranks of a host to its devices round-robin; several ranks share a device if there are fewer devices.
/// Errors  InputError: Backend::cuda and no device; UsageError: an allowed ordinal that the host does not have.
DeviceChoice choose_device(const DeviceRequest& wish);

}  // namespace gigabake
