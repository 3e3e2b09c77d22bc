#include "worker/device/backend.h"

#include <algorithm>

#include "core/base/error.h"
#include "kernels/cuda/baker.h"
#include "kernels/cuda/device/build.h"

namespace gigabake {

int sharers_of_device(int rank, int ranks, int devices) {
  const int turn = rank % devices;
  return ranks / devices + (turn < ranks % devices ? 1 : 0);
}

bool is_built_for_devices() { return !kernels::cuda_build().toolkit.empty(); }

DeviceChoice choose_device(const DeviceRequest& requested) {
  if (requested.backend == Backend::cpu) return {};
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) {
    if (requested.backend == Backend::cuda) throw InputError("`backend` cuda", "", devices.reason);
    return {std::nullopt, devices.reason};
  }
  for (const int device : requested.allowed)
    if (std::find(devices.usable.begin(), devices.usable.end(), device) == devices.usable.end())
      throw UsageError("gpus", "this host has no usable device " + std::to_string(device));
  const std::vector<int>& from = requested.allowed.empty() ? devices.usable : requested.allowed;
  const int device = from[std::size_t(requested.rank_on_host) % from.size()],
            sharers = sharers_of_device(requested.rank_on_host, requested.ranks_on_host, int(from.size()));
  return {device, {}, sharers, kernels::device_memory_bytes(device) / 4 * 3 / std::uint64_t(sharers)};
}

}  // namespace gigabake
