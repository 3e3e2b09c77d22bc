#include "worker/backend.h"

#include <algorithm>

#include "format/error.h"
#include "kernels/cuda_baker.h"

namespace gigabake {

DeviceChoice choose_device(Backend backend, const std::vector<int>& allowed, int rank_on_host) {
  if (backend == Backend::cpu) return {};
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) {
    if (backend == Backend::cuda) throw InputError("--backend cuda", "", devices.reason);
    return {std::nullopt, devices.reason};
  }
  for (const int device : allowed)
    if (std::find(devices.usable.begin(), devices.usable.end(), device) == devices.usable.end())
      throw UsageError("--gpus: this host has no usable device " + std::to_string(device));
  const std::vector<int>& from = allowed.empty() ? devices.usable : allowed;
  return {from[std::size_t(rank_on_host) % from.size()], {}};
}

}  // namespace gigabake
