/// First message to a bake process; it contains everything that the process needs to bake.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/octree/parameters.h"
#include "worker/device/backend.h"
#include "worker/pipeline/cell_pipeline.h"

namespace gigabake {

struct WorkerSetup {
  BakeParameters parameters;
  WorkerOptions worker;  ///< except cuda_device and device_bytes: the process chooses the device itself
  DeviceRequest device;
  /// The serialized sources (format/job/source_bytes.h). Relative paths refer to the working folder that the bake
  /// process inherits from its supervisor.
  std::shared_ptr<const std::vector<std::uint8_t>> sources;
};

/// Serializes all fields except the sources, which are sent before the setup, in parts.
std::vector<std::uint8_t> to_bytes(const WorkerSetup& setup);
/// Returns the setup that to_bytes() serialized, without the sources.
/// Errors  InputError if the bytes are malformed; UsageError if a parameter is out of range.
WorkerSetup setup_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
