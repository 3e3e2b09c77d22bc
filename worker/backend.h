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
};

struct DeviceChoice {
  std::optional<int> device;  ///< none: the CPU
  std::string reason;         ///< why none, where a device was wanted or would have been taken
};

/// Ranks of a host take its devices in turn; several share one where there are fewer.
/// Errors  InputError: Backend::cuda and no device; UsageError: an allowed ordinal that the host does not have.
DeviceChoice choose_device(const DeviceWish& wish);

}  // namespace gigabake
