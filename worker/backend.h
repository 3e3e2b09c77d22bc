/// Where a rank's kernels run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gigabake {

enum class Backend : std::uint8_t { automatic, cpu, cuda };

struct DeviceChoice {
  std::optional<int> device;  ///< none: the CPU
  std::string reason;         ///< why none, where a device was wanted or would have been taken
};

/// The device of the rank that is the host's `rank_on_host`-th: ranks take devices in turn, several share one where
/// there are fewer. allowed: ordinals to choose from; empty: all.
/// Errors  InputError: Backend::cuda and no device; UsageError: an allowed ordinal that the host does not have.
DeviceChoice choose_device(Backend backend, const std::vector<int>& allowed, int rank_on_host);

}  // namespace gigabake
