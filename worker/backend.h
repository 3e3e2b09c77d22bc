/// Where a rank's kernels run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lattice/rules.h"

namespace gigabake {

enum class Backend : std::uint8_t { automatic, cpu, cuda };
template <>
constexpr auto names_of<Backend>() {
  return std::to_array<std::string_view>({"auto", "cpu", "cuda"});
}

/// What was asked for, of the rank that is the host's `rank_on_host`-th.
struct DeviceWish {
  Backend backend = Backend::cpu;
  std::vector<int> allowed = {};  ///< ordinals to choose from; empty: all
  int rank_on_host = 0;
  int ranks_on_host = 1;
};

struct DeviceChoice {
  std::optional<int> device;  ///< none: the CPU
  std::string reason;         ///< why none, where a device was wanted or would have been taken
  int sharers = 1;            ///< ranks of the host that take this device, this one among them
};

/// Of `ranks` that take `devices` in turn, how many take the one that rank `rank` takes. Range  0 ≤ rank < ranks;
/// devices > 0.
int sharers_of_device(int rank, int ranks, int devices);

/// Ranks of a host take its devices in turn; several share one where there are fewer.
/// Errors  InputError: Backend::cuda and no device; UsageError: an allowed ordinal that the host does not have.
DeviceChoice choose_device(const DeviceWish& wish);

}  // namespace gigabake
